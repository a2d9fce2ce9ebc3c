"""Faults planted in a scratch copy of the sources, one at a time: does a test see them?"""
