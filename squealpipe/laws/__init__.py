"""Constitutive laws: one function a law, one home for each equation.

Every law is written with +, −, × and ``**`` only, so the same function serves floats, NumPy
arrays, SymPy symbols and heyoka expressions. Arguments named ``p`` are anything with the
attributes of :class:`squealpipe.parameters.Parameters`.
"""
