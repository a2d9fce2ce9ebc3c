"""Tests of pne_sym."""
