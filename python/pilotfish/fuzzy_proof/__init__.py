"""Machine-checked facts on a fuzzy file, by interval branch and bound over its exact centroid, outward rounded.

``proof.prove`` answers all questions at once; the modules answer one each, and none is imported before it is asked:

- ``interval``, ``boxes``: arithmetic that encloses; parts of the plane of inputs;
- ``strips``, ``layers``, ``pieces``: the law as rational functions, in exact rationals;
- ``enclosure``: bounds of u and of its slopes over boxes;
- ``branch``, ``facts``, ``jumps``, ``rises``: branch and bound; range, steepness, sign; continuity; monotony;
- ``table``, ``model``, ``following``: sup u over any box; an invariant of following a leader that brakes dead;
- ``worst_case``, ``replay_files``: a run that breaks it, as a scenario.

The exact statements, and what is not proved: docs/proof.md.
"""
