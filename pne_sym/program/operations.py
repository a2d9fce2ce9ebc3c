"""The operations of public functions: one definition each, on arrays over states.

Operands are arrays (states, *shape).  An operation that can fail gives NaN where it fails and says
there which status that is; every other status and all that follows is settled in one place, where
a public function ends: what is not finite is NaN as a whole.
"""

from __future__ import annotations

from pne_sym.program import array_operations, equation_operations, pose_operations

OPERATIONS = (
    array_operations.OPERATIONS | equation_operations.OPERATIONS | pose_operations.OPERATIONS
)
