"""What `vpslam bench` does with sequences: which (catalogue, discovery), each run of one (runs), its
figures (scores, timing), and what is made of them (tables, report)."""
