"""What the suite spread leaves behind: runs.csv, summary.csv, comparison.csv and results.md, all of
them written anew after each run, so that they tell what is known so far."""

from vpslam_tools.benchmark import paired, report, runs, spread

EXPLANATION = """\
ATE: RMSE after alignment by a similarity. Rotation: RMSE of the angle left after one constant
rotation. Coverage: frames with a pose / frames from the first one on. 90 %: what nine of ten runs
are not worse than. A run without poses counts as worse than any other ("none").
"""
COMPARED = """\
Pairs of runs with the same first frame and seed. Baseline, judged: medians; ratio: judged /
baseline, over all the geometric mean. p: of the two-sided sign test over better and worse; pairs
that are equal are left out of it.
"""


class Report:
    def __init__(self, args, jobs, judged, baseline, earlier):
        """jobs: [(runs.Job, its side)]. judged, baseline: sides, with the folder `out`; baseline is
        None where there is none or its results are `earlier`, a folder."""
        self._args, self._judged, self._baseline = args, judged, baseline
        self._earlier = spread.read_rows(earlier / "runs.csv") if earlier else None
        self._commits = [report.revision()] if report.revision() else []
        self._places = {job.results: (place, side) for place, (job, side) in enumerate(jobs)}
        self._rows = {side: {} for side in (judged, baseline) if side}
        for job, _ in jobs:
            run = runs.read_complete(job)
            if run:
                self._put(job, run)

    def add(self, job, run):
        """run: of runs.run_jobs()"""
        self._write(self._put(job, run))

    def text(self):
        """Of results.md."""
        parts = ["# Suite spread\n", report.origin(report.command_line(), self._commits),
                 spread.table(spread.summarise(self._of(self._judged)), self._args.runs),
                 EXPLANATION]
        reasons = dict.fromkeys((row["sequence"], row["why"]) for row in self._of(self._judged)
                                if row["why"])
        parts += [f"- {name}: {why}" for name, why in reasons] + [""] * bool(reasons)
        if self._args.against:
            lines, unlike = self._compared()
            parts.append(f"## Against {self._args.against}\n")
            parts += [paired.text(lines), COMPARED] if lines else ["No pair is complete.\n"]
            parts += [f"{name}: {count} runs are left out, for their frames, calibration or truth "
                      "differ.\n" for name, count in unlike.items()]
        return "\n".join(parts)

    def _put(self, job, run):
        place, side = self._places[job.results]
        self._rows[side][place] = spread.row_of(
            run, start=job.about["start"], inputs=job.about["seen"],
            programs=job.key["programs"], settings=job.about["settings"])
        return side

    def _of(self, side):
        """Rows in the order of the runs."""
        return [row for _, row in sorted(self._rows[side].items())]

    def _write(self, side):
        rows = self._of(side)
        summary = spread.summarise(rows)
        spread.write_csv(side.out / "runs.csv", spread.COLUMNS, rows)
        spread.write_csv(side.out / "summary.csv", list(summary[0]), summary)
        lines, _ = self._compared()
        if lines:
            spread.write_csv(self._args.out / "comparison.csv", paired.COLUMNS, lines)
        (self._args.out / "results.md").write_text(self.text())

    def _compared(self):
        """(of paired.compare(), {sequence: runs that cannot be compared})"""
        if self._baseline is None and self._earlier is None:
            return [], {}
        pairs, unlike = paired.pair(self._of(self._baseline) if self._baseline else self._earlier,
                                    self._of(self._judged))
        return paired.compare(pairs) if pairs else [], unlike
