"""An elastic pad on one, two and more contact points, and a stiff one."""

from squealpipe.paper.contact_points import Run, contact_points
from squealpipe.study.job import Job

job = Job(snakemake)
section = dict(job.settings["contact_points"])
points, stiff = section.pop("points"), section.pop("stiff_points")
how = Run(**section)
job.make(lambda: contact_points(points, stiff, how, workers=snakemake.threads))
