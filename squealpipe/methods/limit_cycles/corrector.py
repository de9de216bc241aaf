"""Pseudo-arclength continuation for equations that are dear to evaluate."""

from __future__ import annotations

import numpy as np

from squealpipe.methods.continuation import Problem, PseudoArclength, Vector


class Corrector(PseudoArclength):
    """Accepts a guess as it is where it solves the equations; the tangent is the point's own."""

    def correct(
        self, problem: Problem, guess: Vector, normal: Vector, least_iterations: int = 0
    ) -> tuple[Vector, Vector, int, float] | None:
        """Newton's method with normal · dz = 0.

        Returns:
            (point, tangent, iterations, residual), or None where it does not converge. The
            tangent is oriented along ``normal``.
        """
        z, settings = guess, self.settings
        right = np.zeros((len(z), 2))
        right[-1, 1] = 1.0
        previous = np.inf
        for iteration in range(settings.max_iterations + 1):
            values, jacobian = problem.evaluate(z)
            residual = float(np.abs(values).max())
            if not residual < max(10.0 * previous, settings.tolerance):
                return None
            right[:-1, 0] = -values
            try:
                step, tangent = np.linalg.solve(np.vstack([jacobian, normal]), right).T
            except np.linalg.LinAlgError:
                return None
            stagnates = 0.2 * previous < residual <= settings.stagnant
            if (residual <= settings.tolerance or stagnates) and iteration >= least_iterations:
                return z, tangent / np.linalg.norm(tangent), iteration, residual
            z, previous = z + step, residual
        return None
