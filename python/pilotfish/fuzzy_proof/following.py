"""An invariant of following on a straight line: the distance never falls below the stop distance. Model and derivation.

**Model** (that of pilotfish.sim's Unicycle behind src/control/follower.cpp with profile ``paper``, on a line). At the
exposures t_k = k T the follower measures the distance d with an error of at most N and commands

    e_k  = d_p - d(t_k) - n_k,  |n_k| <= N,     ec_k = e_k - e_(k-1)      (0 at the first)
    w_k  = V_s u(e_k / E_s, ec_k / EC_s)                                  what the law wants
    c_k  = w_k, at most a T from c_(k-1), held in [-V_r, V]               src/control/limits.cpp

which acts one latency L after the exposure, until the next acts. The driver's set value r ramps to it with the
acceleration a; the wheels follow with a lag tau; the leader drives at v_l:

    r' = +-a until r = c_k,      tau v' = r - v,      d' = v_l - v,      0 <= v_l <= V_l,   v_l' >= -b.

The leader may speed up as it likes and brake with b at any time: it "brakes dead". It never reverses.

**Without lag and latency.** Let x+ be max(x, 0) and C_k = (c_k)+. Reversing only helps, so follow a robot that rests
where ours reverses: the same with r+ in place of r is never farther from the leader, because v+ <= the lag's answer
to r+. For

    p_k = d(t_k) - tau v+(t_k) - int over [t_k, t_k + L] of r+ dt

tau v' = r - v makes the lag disappear, and what is committed already makes the latency disappear:

    p_(k+1) >= p_k + (way of the leader) - int over [t_k + L, t_(k+1) + L] of r+ dt,
    that integral <= C_k T - D |D| / 2a   with  D = C_k - C_(k-1),  |D| <= a T

(r has reached c_(k-1) when c_k begins to act, and ramps from there). If the robot brakes as hard as it may from now on
and the leader, too, then r+ still makes C_(k-1)^2 / 2a, the leader kappa = v_l^2 / 2b, and both come to rest at the
distance p_k + kappa - C_(k-1)^2 / 2a. With y_k = p_k + kappa(v_l(t_k)) the *safe set* is

    S:   y >= D_stop + C^2 / 2a.

kappa may be credited only if b >= a: then the closing speed of two that brake cannot fall before the leader stands
(v' >= -a, and v_l' = -b), so from the first moment at which d = D_stop is crossed, with the robot the faster of the
two, d would only go on falling to the final distance, and that is >= D_stop. So in S no distance between two
exposures is below it either. If b < a, the leader is taken to stop dead, kappa = 0.

**What is proved.** That S is never left: for each (y, C, v_l) in S, each measurement and each way of the leader, the
next is in S,

    y_(k+1) >= y_k - (C_k T - D |D| / 2a) >= D_stop + C_k^2 / 2a        (*)

(y falls least favourably if the leader brakes with b: its way and what is left of kappa then add up to kappa.) Braking
at full, C_k = (C - a T)+, keeps S exactly, both sides of (*) fall alike; so it is enough that the law wants no more
than that, or that there is room for what it wants. The left side of (*) less the right falls as C_k rises (|D| <= a T),
so an upper bound of w_k is enough, and whatever lowers a command (the collision guard) keeps the proof. By
induction S holds for all time; a robot at rest, at any d >= D_stop, is in S.

**What the law sees in S.** r'  is within +-a and r = c when the next command begins to act, so s before that r is
within c +- a s, and the wheels within c +- a (s + tau). Hence

    v+(t_k) in [(c - a (L + tau))+, (c + a (L + tau))+],     the integral in p_k in [(c L - a L^2/2)+, c L + a L^2/2],

both of v+ and r at most V; d(t_k) = p_k + tau v+ + that integral, and at least D_stop. The mean speed since t_(k-1) is
within c +- a (L + tau + T/2) and [-V_r, V], the leader's within [0, min(V_l, v_l + b T/2)]; their difference times T,
+-2N, is ec_k. Where C = 0, c is anything in [-V_r, 0].

Branch and bound over (y, C, v_l), all of it in interval arithmetic, shows (*). For y >= D_stop + V T + V^2/2a + a T^2/2
it holds whatever the law wants, so the region is bounded.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from pilotfish.fuzzy_proof.interval import Interval
from pilotfish.fuzzy_proof.model import RANGES, Following
from pilotfish.fuzzy_proof.table import GreatestOver

MAX_BOXES = 100_000  # some 2 s; a proof takes a few hundred
_FINEST = 2.0**-12  # of the region along y and C: what is not shown on so small a box counts as not shown


@dataclass(frozen=True)
class Invariant:
    """Whether S is never left. If that was not shown: a state (y, C, v_l) around which it was not."""

    holds: bool
    boxes: int
    open_state: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class _Region:
    """Boxes of (y, C, v_l), each (N,)."""

    y: Interval
    speed: Interval
    leader: Interval

    def __getitem__(self, which: np.ndarray) -> _Region:
        return _Region(self.y[which], self.speed[which], self.leader[which])


def prove_invariant(model: Following, greatest: GreatestOver) -> Invariant:
    """Shows (*) by branch and bound. ``greatest`` bounds u over any box of inputs, in units of the universes."""
    region = _whole(model)
    smallest = [_FINEST * float((x.hi - x.lo)[0]) for x in (region.y, region.speed)]
    seen = 0
    while len(region.y.lo):
        seen += len(region.y.lo)
        region = _inside_s(model, region)
        open_ = region[~_kept(model, greatest, region)]
        if not len(open_.y.lo):
            break
        small = (open_.y.hi - open_.y.lo <= smallest[0]) & (open_.speed.hi - open_.speed.lo <= smallest[1])
        if small.any() or seen > MAX_BOXES:
            worst = int(np.argmax(small))
            state = tuple(float(0.5 * (x.lo[worst] + x.hi[worst])) for x in (open_.y, open_.speed, open_.leader))
            return Invariant(False, seen, state)  # type: ignore[arg-type]
        region = _halves(model, open_)
    return Invariant(True, seen)


def _whole(model: Following) -> _Region:
    top, a, period = (_of(getattr(model, name)) for name in ("speed_limit_mps", "acceleration_mps2", "period_s"))
    room = top * period + top * top / (_of(2.0) * a) + a * period * period / _of(2.0)
    stop = _of(model.stop_distance_m)
    one = np.ones(1)
    return _Region(
        Interval(stop.lo * one, (stop + room).hi * one),
        Interval(0.0 * one, top.hi * one),
        Interval(0.0 * one, model.leader_speed_mps * one),
    )


def _of(number: float) -> Interval:
    return Interval.point(number)


def _positive(x: Interval) -> Interval:
    return Interval(np.maximum(x.lo, 0.0), np.maximum(x.hi, 0.0))


def _braking_m(model: Following, speed: Interval) -> Interval:
    return speed * speed / (_of(2.0) * _of(model.acceleration_mps2))


def _inside_s(model: Following, region: _Region) -> _Region:
    """The boxes that have a part in S, each without what of it certainly lies outside."""
    least = _of(model.stop_distance_m) + _braking_m(model, Interval(region.speed.lo, region.speed.lo))
    y = Interval(np.maximum(region.y.lo, least.lo), region.y.hi)
    return _Region(y, region.speed, region.leader)[y.lo <= y.hi]


def _kept(model: Following, greatest: GreatestOver, region: _Region) -> np.ndarray:
    """Where (*) is shown for every state of the box."""
    a, period, top = _of(model.acceleration_mps2), _of(model.period_s), model.speed_limit_mps
    u = greatest(*_seen_by_law(model, region))
    # A positive scale keeps the sign: what is at most zero must not become the smallest double above it.
    scaled = _of(model.velocity_scale_mps) * Interval.point(u)
    wanted = Interval(scaled.lo, np.where(u <= 0.0, np.minimum(scaled.hi, 0.0), scaled.hi))
    step = a * period
    slowest = Interval(region.speed.lo, region.speed.lo) - step
    brakes = wanted.hi <= np.maximum(slowest.lo, 0.0)

    speed = Interval(region.speed.hi, region.speed.hi)
    next_speed = np.maximum.reduce([wanted.hi, (speed - step).hi, np.zeros_like(wanted.hi)])
    next_ = Interval.point(np.minimum.reduce([next_speed, (speed + step).hi, np.full_like(next_speed, top)]))
    change = next_ - speed
    square = change * change.absolute()
    way = next_ * period - square / (_of(2.0) * a) + _braking_m(model, next_)
    has_room = region.y.lo >= (_of(model.stop_distance_m) + way).hi
    return brakes | has_room


def _seen_by_law(model: Following, region: _Region) -> tuple[Interval, Interval]:
    """(e / E_s, ec / EC_s): all that the law may measure in these states."""
    a, latency, lag, period = (
        _of(getattr(model, name)) for name in ("acceleration_mps2", "latency_s", "lag_s", "period_s")
    )
    top, reverse = model.speed_limit_mps, model.reverse_limit_mps
    command = Interval(np.where(region.speed.lo > 0.0, region.speed.lo, -reverse), region.speed.hi)
    behind = a * (latency + lag)
    wheels = _positive(Interval((command - behind).lo, np.minimum((command + behind).hi, top)))
    ramp = a * latency * latency / _of(2.0)
    committed = _positive(
        Interval((command * latency - ramp).lo, np.minimum((command * latency + ramp).hi, (_of(top) * latency).hi))
    )
    distance = region.y - _credit(model, region.leader) + lag * wheels + committed
    distance = Interval(np.maximum(distance.lo, model.stop_distance_m), distance.hi)
    noise = Interval(-np.float64(model.noise_m), np.float64(model.noise_m))
    e = (_of(model.setpoint_m) - distance + noise) / _of(model.error_scale_m)

    since = a * (latency + lag + period / _of(2.0))
    mean = Interval(np.maximum((command - since).lo, -reverse), np.minimum((command + since).hi, top))
    before = (region.leader + _of(model.leader_deceleration_mps2) * period / _of(2.0)).hi
    leader = Interval(np.zeros_like(before), np.minimum(before, model.leader_speed_mps))
    ec = ((mean - leader) * period + noise + noise) / _of(model.error_change_scale_m)
    return e, ec


def _credit(model: Following, leader: Interval) -> Interval:
    """kappa, the way of the leader that brakes: v_l^2 / 2b, or none if it brakes more gently than the robot."""
    if model.leader_deceleration_mps2 < model.acceleration_mps2:
        return Interval(np.zeros_like(leader.lo), np.zeros_like(leader.hi))
    return leader * leader / (_of(2.0) * _of(model.leader_deceleration_mps2))


def _halves(model: Following, region: _Region) -> _Region:
    """Both halves of every box, across the side that changes the law's inputs most."""
    per_e, per_ec = 1.0 / model.error_scale_m, model.period_s / model.error_change_scale_m
    wide = [x.hi - x.lo for x in (region.y, region.speed, region.leader)]
    braking_s = region.speed.hi / model.acceleration_mps2
    moved = model.leader_speed_mps / max(model.leader_deceleration_mps2, model.acceleration_mps2)
    effect = np.array(
        [
            wide[0] * per_e,
            wide[1] * (per_ec + (model.lag_s + model.latency_s + model.period_s + braking_s) * per_e),
            wide[2] * (moved * per_e + (per_ec if model.leader_deceleration_mps2 * model.period_s < 1.0 else 0.0)),
        ]
    )
    across = np.argmax(effect, axis=0)

    def half(x: Interval, which: int, right: bool) -> Interval:
        middle = 0.5 * (x.lo + x.hi)
        cut = across == which
        return Interval(np.where(cut & right, middle, x.lo), np.where(cut & (not right), middle, x.hi))

    def side(right: bool) -> _Region:
        return _Region(half(region.y, 0, right), half(region.speed, 1, right), half(region.leader, 2, right))

    left, right = side(False), side(True)

    def joined(one: Interval, other: Interval) -> Interval:
        return Interval(np.concatenate([one.lo, other.lo]), np.concatenate([one.hi, other.hi]))

    return _Region(joined(left.y, right.y), joined(left.speed, right.speed), joined(left.leader, right.leader))


def largest_speed(model: Following, greatest: GreatestOver, steps: int = 7) -> float | None:
    """The greatest speed limit up to the model's at which the invariant is proved, found by bisection; None: none
    is."""
    return _bisect(lambda speed: replace(model, speed_limit_mps=speed), 0.01, model.speed_limit_mps, greatest, steps)


def least_setpoint(model: Following, greatest: GreatestOver, highest_m: float, steps: int = 8) -> float | None:
    """The least setpoint up to ``highest_m`` at which the invariant is proved, found by bisection; None: none is."""
    lowest_m = max(model.stop_distance_m, RANGES["setpoint_m"][0])
    return _bisect(lambda setpoint: replace(model, setpoint_m=setpoint), highest_m, lowest_m, greatest, steps)


def _bisect(
    vary: Callable[[float], Following], good: float, bad: float, greatest: GreatestOver, steps: int
) -> float | None:
    """Between a value at which it should be proved and one at which it should not be. Each value stands for itself:
    what is returned is proved, whether or not all between are."""
    if prove_invariant(vary(bad), greatest).holds:
        return bad
    if not prove_invariant(vary(good), greatest).holds:
        return None
    for _ in range(steps):
        middle = 0.5 * (good + bad)
        if prove_invariant(vary(middle), greatest).holds:
            good = middle
        else:
            bad = middle
    return good
