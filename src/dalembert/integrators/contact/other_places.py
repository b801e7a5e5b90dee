"""Arrays of sweeps and of the search for features of hulls in machine code, where they differ from
those of ``places``."""

from __future__ import annotations

from dalembert.integrators.contact.places import Places


class SweepOutputs(Places):
    """``res`` of sweeps."""

    IMPULSE = 0
    SPEEDS = 1  # of the bodies


class SweepCounts(Places):
    """``iw`` of sweeps."""

    CONTACTS = 0
    COMPONENTS = 1  # of a contact
    GROUPS = 2  # of tangential components
    MAX_SWEEPS = 3
    SPEEDS = 4  # of the bodies
    DEPTH = 5  # stored sweeps


class SweepSettings(Places):
    """``arg[SETTINGS]`` of sweeps."""

    TOLERANCE = 0  # change of velocity [m/s]
    GROWTH = 1  # of the squared changes after which stored sweeps are forgotten
    REGULARIZATION = 2  # of the least-squares problem


class SearchInputs(Places):
    """``arg`` of the search for features of hulls."""

    CORNERS = 0  # of all hulls
    REACH = 1  # of each pair, without the radii
    PAIRS = 2  # both hulls
    ROUNDED = 3  # whether one hull of a pair has a radius
    PLACES = 4  # of the record, the corners and the axes of each hull
    FORMS = 5  # class Forms, of each form, then its lists


class SearchOutputs(Places):
    """``res`` of the search for features of hulls."""

    FEATURES = 0  # kind, pair, whether the second hull is first, both features
    PAIR_FEATURES = 1  # memory for those of one pair
    AXES = 2  # of all hulls


class SearchCounts(Places):
    """``iw`` of the search for features of hulls."""

    PAIRS = 0
    HULLS = 1
    DIMENSION = 2
    MAX_FEATURES = 3  # memory
    FEATURES = 4  # above the memory if that does not suffice
