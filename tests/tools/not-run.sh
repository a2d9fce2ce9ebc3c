#!/bin/sh
# Tell, so that it is seen, that a check could not run here; in CI that is a failure.
printf '\n*** NOT RUN: %s ***\n\n' "$1" >&2
[ "${CI:-}" != true ]
