"""A published mode-coupling model by our A3, and accuracy at the onset of flutter."""

from squealpipe.store import produce
from squealpipe.tasks.linear.mode_coupling import mode_coupling

produce(mode_coupling, config={}, key=snakemake.params.key, output=snakemake.output[0])
