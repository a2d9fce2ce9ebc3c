"""Every function of every catalogue entry in Octave, against the NumPy modules."""

from __future__ import annotations

from pathlib import Path

import pytest

from pne_sym import manipulators
from tests import models
from tests.octave.conformance import conforms, end_to_end
from tests.whole.test_coupling import coupled
from tests.whole.test_moving_base import carried


@pytest.mark.parametrize("name", manipulators.names())
def test_equal_to_the_numpy_module(name: str) -> None:
    conforms(models.catalogue(name))


@pytest.mark.parametrize("file", ["planar_3rrr", "spatial_2rr_2hr", "spherical_2crp_redundant"])
def test_closures_with_more_and_with_as_many_conditions_as_unknowns(file: str) -> None:
    conforms(models.drawn(file))


def test_on_a_base_that_moves() -> None:
    conforms(carried("planar_3rpr"))


def test_with_coupled_motors() -> None:
    conforms(coupled("planar_3rpr"))


def test_from_the_command_line_to_octave(tmp_path: Path) -> None:
    end_to_end("stewart", tmp_path)
