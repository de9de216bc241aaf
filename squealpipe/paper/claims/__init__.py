"""The paper's statements as data, checks that read datasets only, and their verdicts.

A row of the table is a :class:`~squealpipe.paper.claims.statement.Statement`; its check looks at
the datasets of one run and returns a :class:`~squealpipe.paper.claims.evidence.Finding`. ``judge``
runs all checks, ``table`` reads the verdicts back.
"""
