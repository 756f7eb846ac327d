"""What stands before a stage: a guard that judges, bridges or refuses samples; or an arm's."""

from __future__ import annotations

from collections.abc import Mapping

from rotatum.kernels import guard, rotatum, rows
from rotatum.record import Field, Layout, integer
from rotatum.runtime.compose import write_kernels
from rotatum.runtime.errors import StageError
from rotatum.runtime.stage import Stage


def guarded(
    inner: Stage,
    outer: Layout,
    channels: tuple[str, ...],
    wires: Mapping[str, str],
) -> Stage:
    """Put the guard before a stage.

    A refused sample leaves ``inner`` as it was and repeats its last output with the reason in
    ``status``.

    Args:
        inner: its output has ``time`` and ``status``; it can hold its output.
        outer: what is read: ``time``, the channels, and fields that are handed on as they are.
        channels: the float fields of ``outer`` the guard watches and interpolates.
        wires: field of ``inner``'s input, dotted where it is nested, to a field of ``outer``.
            Fields called ``fresh`` are the guard's: 1 where the filters must start.
    """
    if inner.hold is None:
        raise StageError(f"{inner.name} cannot hold its output, so it cannot be guarded")
    missing = sorted({*channels, *wires.values(), "time"} - set(outer.fields))
    if missing:
        raise StageError(f"{outer.name} lacks what the guard of {inner.name} reads", value=missing)
    name = f"{inner.name}_guarded"
    c = len(channels)
    doc = f"{inner.name} behind a guard against bad samples."
    params = Layout(
        f"{name}_params",
        doc,
        {"guard": Field(guard.GuardParams.layout(c=c)), "inner": Field(inner.params)},
    )
    state = Layout(
        f"{name}_state",
        doc,
        {
            "guard": Field(guard.GuardState.layout(c=c)),
            "inner": Field(inner.state),
            "sample": Field(inner.input),
        },
    )
    kernels = {
        "guard_init": guard.init,
        "guard_plan": guard.plan,
        "guard_fill": guard.fill,
        "guard_finish": guard.finish,
        "inner_init": inner.init,
        "inner_step": inner.step,
        "inner_hold": inner.hold,
    }
    init_lines = [
        "guard_init(params.guard, state.guard)",
        "inner_init(params.inner, state.inner)",
    ]
    lines = _lines(inner.input, channels, wires)
    init, step = write_kernels(name, doc, init_lines, lines, kernels)
    return Stage(name, params, state, outer, inner.output, init, step, inner.cites)


def linked(inner: Stage) -> Stage:
    """Put a stage behind the guard of its arm, which tells when to hold and what was wrong.

    Args:
        inner: reads ``LinkSample`` or ``RotatumSample``; its output has ``time`` and ``status``;
            it can hold its output.
    """
    samples = (rows.LinkSample.layout(), rotatum.RotatumSample.layout())
    if inner.hold is None or inner.input not in samples:
        raise StageError(f"{inner.name} is no estimator of a joint seen from its link")
    name = f"{inner.name}_linked"
    doc = f"{inner.name} behind the guard of its arm."
    own = {
        "hold": integer("1: the sample was refused, the output is repeated"),
        "status": integer("status bits of the sample"),
    }
    fields = dict(inner.input.fields)
    outer = Layout(f"arm_{inner.input.name}", "One sample of a joint of an arm.", {**fields, **own})
    copied = [f"    state.sample.{field} = u.{field}" for field in fields]
    lines = [
        "if u.hold != 0:",
        "    inner_hold(params.inner, state.inner, out)",
        "else:",
        *copied,
        "    inner_step(params.inner, state.inner, state.sample, out)",
        "out.time = u.time",
        "out.status = out.status | u.status",
    ]
    kernels = {"inner_init": inner.init, "inner_step": inner.step, "inner_hold": inner.hold}
    starts = ["inner_init(params.inner, state.inner)"]
    init, step = write_kernels(name, doc, starts, lines, kernels)
    params = Layout(f"{name}_params", doc, {"inner": Field(inner.params)})
    memory = {"inner": Field(inner.state), "sample": Field(inner.input)}
    state = Layout(f"{name}_state", doc, memory)
    return Stage(name, params, state, outer, inner.output, init, step, inner.cites)


def _lines(input: Layout, channels: tuple[str, ...], wires: Mapping[str, str]) -> list[str]:
    starts = _starts(input)
    place = {name: f"state.guard.mix[{i}]" for i, name in enumerate(channels)}
    place["time"] = "state.guard.mix_time"
    inside = ["guard_fill(params.guard, state.guard, u.time, k, steps)"]
    inside += [
        f"state.sample.{target} = {place.get(source, f'u.{source}')}"
        for target, source in wires.items()
    ]
    inside += [f"state.sample.{target} = 0" for target in starts]
    inside += ["if k == 0:"]
    inside += [f"    state.sample.{target} = state.guard.fresh" for target in starts]
    inside += ["inner_step(params.inner, state.inner, state.sample, out)"]
    return [
        *(f"state.guard.now[{i}] = u.{name}" for i, name in enumerate(channels)),
        "steps = guard_plan(params.guard, state.guard, u.time)",
        "for k in range(steps):",
        *(f"    {line}" for line in inside),
        "if steps > 0:",
        "    guard_finish(params.guard, state.guard, u.time)",
        "else:",
        "    inner_hold(params.inner, state.inner, out)",
        "out.time = u.time",
        "out.status = out.status | state.guard.status",
    ]


def _starts(input: Layout, within: str = "") -> list[str]:
    """Dotted names of the fields ``fresh`` of a record and of those in it."""
    found = [f"{within}fresh"] if "fresh" in input.fields else []
    for name, field in input.fields.items():
        if isinstance(field.kind, Layout):
            found += _starts(field.kind, f"{within}{name}.")
    return found
