"""The former baseline, at which the facts known from outside the project were determined."""

from squealpipe.parameters import Parameters

FORMER = Parameters(k3=0.75, mu=0.3, belt_speed=100.0, length1=5.0, length2=5.0)
