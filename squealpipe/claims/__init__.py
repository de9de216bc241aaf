"""The paper's statements as data, checks that read datasets only, and their verdicts.

A row of the table is a :class:`~squealpipe.claims.statement.Statement`; its check looks at the
datasets of one run and returns a :class:`~squealpipe.claims.evidence.Finding`.
:func:`squealpipe.claims.judge.judge` runs all checks, :mod:`squealpipe.claims.table` reads the
verdicts back.
"""
