"""What actuators and constraints determine, whatever the parameters and the pose."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Actuation:
    """Generic ranks of the force transformation: those of almost all parameters and poses.

    K = [H Hk] has NV rows.  Those of passive extra coordinates (extra joints that are not
    actuated) need no force of their own: these coordinates move as they must.

    Attributes:
        rank: of K.
        force_rank: of H.
        passive: rows of the passive extra coordinates.
        others: all other rows.
        is_determined: the other rows are independent: some forces hold them, whatever they need.
        is_coupled: actuators or constraints act on passive extra coordinates.
        completes: rows left idle feel the accelerations of passive extra coordinates, which so
            follow from the others.
    """

    rank: int
    force_rank: int
    passive: tuple[int, ...]
    others: tuple[int, ...]
    is_determined: bool
    is_coupled: bool
    completes: bool = True

    @property
    def idle(self) -> int:
        """Combinations of rows on which neither actuators nor constraints act.

        As many conditions does the acceleration obey, whatever the actuators do.
        """
        return len(self.passive) + len(self.others) - self.rank

    @property
    def solved(self) -> tuple[int, ...]:
        """Rows from which inverse dynamics finds the forces.

        Where the rank is that of the other rows, those of passive extra coordinates follow from
        them or are zero, and add nothing.  Where it is larger, all rows take part.
        """
        if not self.is_determined or self.rank == len(self.others):
            return self.others
        return tuple(sorted((*self.passive, *self.others)))

    @property
    def surplus(self) -> int:
        """Rows solved beyond the rank: their right side is first brought into the range of K."""
        return len(self.solved) - self.rank if self.is_determined else 0
