"""What stands behind scripts/vpslam: building, launching, evaluating."""
