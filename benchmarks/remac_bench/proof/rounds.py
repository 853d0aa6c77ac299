"""The recorded subtasks of a job played again, where who chose them cannot be asked again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from typing import Any

from remac_bench.entries import EXCHANGES_MAX
from remac_bench.playing import agents
from remac_bench.playing.episodes import Course, made_from, make_record, proven
from remac_bench.playing.jobs import Job
from remac_bench.playing.outside import plugins
from remac_bench.playing.shared import make
from remac_bench.playing.timing import StepBook, replayed, shortest, timeline, token_of
from remac_bench.playing.worlds import as_values, fallen
from remac_bench.proof.again import NOT_PROVEN, as_told, check_key, compare, of_this_code, read_job
from remac_bench.records import CheckEntry, Record
from remac_env.errors import RemacError
from remac_env.oracle import certify, problem_id
from remac_env.robots import bodies
from remac_env.state import WorldState

PLAYED: tuple[str, ...] = (
    *("style", "layout", "digest", "problem", "success", "end", "progress", "phases", "rounds", "outcomes", "worlds"),
    *("sim_seconds", "robot_contacts", "near_misses", "physics_steps", "littered", "goal", "timeline", "orders"),
    *("skills", "skill_cases", "body", "body_digest", "pre_checks", "post_checks", "template", "known_rounds"),
    *("optimum_rounds", "optimum_lower", "optimum_proof", "optimum_seconds", "optimum_seconds_lower"),
)
"""Fields that come out the same when the recorded subtasks are played again, whoever chose them. Of checks that is the
truth beside a verdict."""

AS_TOLD = (
    *("initial_plan", "final_plan", "initial_plan_length", "final_plan_length", "subtasks_done", "retries", "adjusted"),
    *("reflections", "planner_errors", "usage", "exchanges", "adaptations", "error"),
)
"""Fields that are the word of who chose the subtasks: they have to add up, and no more can be said of them."""


def check_rounds(rows: Sequence[Record], *, searched: bool = False) -> Iterator[str]:
    """Play the recorded subtasks again; who chose them is taken as told, and what is told of it must add up.

    Args:
        searched: as `check_job`.
    """
    import remac_env

    yield from _missing_iterations(rows)
    for row in rows:
        if row.infrastructure_error:
            continue
        try:
            job = read_job(row)
            yield from check_key(row, job)
            if row.digest is None:
                yield from _check_unplayed(row, job)
                continue
            yield from _check_sums(row, job)
            env = remac_env.parallel_env(row.task, **asdict(job.options))
        except (RemacError, TypeError, KeyError, ValueError) as error:
            yield f"its options make no job: {error}"
            return
        try:
            again = as_told(row, play_rounds(env, row, searched=searched))
            yield from compare(row.iteration, row.model_dump(), again, PLAYED)
        except (RemacError, KeyError, IndexError, ValueError) as error:
            yield f"iteration {row.iteration}: its subtasks cannot be played: {error}"
        finally:
            env.close()


def _missing_iterations(rows: Sequence[Record]) -> Iterator[str]:
    """Iterations that were left out: what they took counts too."""
    told = sorted(row.iteration for row in rows)
    began = [row.iteration for row in rows if row.digest is not None]
    if told[: len(began)] != list(range(len(began))) or len(told) > len(began) + 1:
        yield f"iterations: recorded {told}, of which {len(began)} began"


def _check_unplayed(row: Record, job: Job) -> Iterator[str]:
    """An episode that never began, because of an error, has nothing to tell."""
    if row.error is None:
        yield f"iteration {row.iteration}: it never began, and nothing says why"
        return
    blank = make_record(job, row.iteration, course=Course(), report={}, fault=None)
    told = [name for name in Record.model_fields if name not in (*NOT_PROVEN, "error", "options", "success")]
    expected = {**blank.model_dump(include=set(told)), "success": False}
    yield from compare(row.iteration, row.model_dump(), expected, list(expected))


def play_rounds(env: Any, row: Record, *, searched: bool = False) -> dict[str, Any]:
    """The fields PLAYED, from the recorded subtasks; `searched`: what is shortest is told for sure."""
    _, infos = env.reset(seed=row.seed)
    start = (env.start.scene, env.world, env.goal)
    outcomes: list[dict[str, Any]] = []
    states = [env.world]
    book = StepBook()
    for number, entry in enumerate(row.outcomes):
        if not env.agents:
            raise ValueError(f"{len(row.outcomes)} rounds recorded, the episode ended after {len(outcomes)}")
        if row.clock == "events" and number >= len(row.orders):
            raise ValueError(f"{len(row.outcomes)} decision points recorded, and orders of {len(row.orders)}")
        if row.clock == "events":
            tokens, thoughts = replayed(env, row.orders[number], infos)
            book.order(env, tokens, infos, thoughts)
        else:
            tokens = {robot: token_of(env, outcome.subtask) for robot, outcome in entry.items()}
        _, _, _, _, infos = env.step(tokens)
        outcomes.append({n: each.model_dump() for n, each in book.ended(env, tokens, infos).items()})
        states.append(env.world)
    shared = next(iter(infos.values()))
    episode, worlds = shared["episode"], [as_values(state) for state in states]
    return {
        "style": episode["style"],
        "layout": episode["layout"],
        "digest": episode["digest"],
        "goal": shared["goal"],
        "success": shared["end"] == "success" and row.error is None,
        "end": shared["end"] or None,
        "progress": round(env.progress, 6),
        "phases": dict(shared["phases"]),
        "rounds": len(outcomes),
        "outcomes": outcomes,
        "worlds": worlds,
        "littered": fallen(worlds),
        "problem": problem_id(*start),
        "template": None, "known_rounds": None, **_noted(row, env),
        "skills": dict(getattr(env, "skills", {})),
        "skill_cases": dict(getattr(env, "skill_cases", {})),
        "body": None, "body_digest": None, **bodies.described(env.start.body),
        **_optimum(env, row, start, searched=searched),
        **{name: _truths(getattr(row, name), env, states) for name in ("pre_checks", "post_checks")},
        "orders": [{robot: each.model_dump() for robot, each in step.items()} for step in book.orders],
        "timeline": [span.model_dump() for span in timeline(env)],
        "sim_seconds": round(float(shared["seconds"]), 6),
        **{name: int(shared[name]) for name in ("robot_contacts", "near_misses", "physics_steps")},
    }


def _noted(row: Record, env: Any) -> dict[str, Any]:
    """What is known of a generated task, where the record has it: older ones do not."""
    whole = of_this_code(row)
    return {name: value for name, value in made_from(env, row.seed).items() if whole or name in row.model_fields_set}


def _optimum(env: Any, row: Record, start: tuple[Any, WorldState, Any], *, searched: bool) -> dict[str, Any]:
    """The fields of what is shortest, where the record has any of them, or has to."""
    told = row.model_dump(include={name for name in PLAYED if name.startswith("optimum")})
    if not searched and all(value is None for value in told.values()):
        return told
    nothing: dict[str, Any] = dict.fromkeys(told)
    return {**nothing, **(shortest(env) if row.clock == "events" else proven(certify(*start)))}


def _truths(checks: Sequence[CheckEntry], env: Any, states: Sequence[WorldState]) -> list[dict[str, Any]]:
    """The checks with what was true then; what no predicate says as it stands."""
    from remac_env.rules.scene import public_scene
    from remac_env.rules.sentences import read_condition

    told, kitchen = [], public_scene(env.start.scene)
    for check in checks:
        values = check.model_dump()
        condition = None if check.unmatched else read_condition(check.condition, kitchen, robot=check.robot)
        if condition is not None:
            values["truth"] = condition.holds(env.start.scene, states[check.round])
        elif not check.unmatched:
            values["condition"] = "(no predicate says this)"
        told.append(values)
    return told


def _check_sums(row: Record, job: Job) -> Iterator[str]:
    """What follows from a record's own other fields, where the agent itself cannot be asked again."""
    recorded = row.model_dump()
    expected = {
        "agent": job.label,
        "backend": job.options.backend,
        "starts": job.options.starts,
        "robots": job.options.robots,
        "clock": job.options.clock,
        "scored": row.iteration == job.iterations and not row.infrastructure_error,
        "rounds": len(row.outcomes),
        **_readers(row, job),
    }
    if row.error is None:
        expected["success"] = row.end == "success"
        lengths = {"initial_plan_length": row.initial_plan, "final_plan_length": row.final_plan}
        plans = {name: plan for name, plan in lengths.items() if recorded[name] is not None}
        expected |= {name: max(map(len, plan.values()), default=0) for name, plan in plans.items()}
    yield from compare(row.iteration, recorded, expected, list(expected))
    yield from (f"iteration {row.iteration}, {told}" for told in (*_wrong_sums(row, job), *_wrong_words(row, job)))


def _wrong_sums(row: Record, job: Job) -> Iterator[str]:
    told = {name: value for name, value in row.options.items() if name not in ("access", "viewers")}
    if set(told) - set(job.facts) or set(told.get("kitchen", {})) - set(job.facts["kitchen"]):
        yield f"options: {told} has more than the job it makes: {job.facts}"
    if row.error is None and row.end is None:
        yield "error: the episode was not over, and nothing says why"
    if not 0 <= row.iteration <= job.iterations:
        yield f"iteration: the job has {job.iterations}"
    if row.final_plan_length is not None and not 0 <= row.subtasks_done <= min(row.final_plan_length, row.rounds):
        yield f"subtasks_done: {row.subtasks_done} of {row.final_plan_length}, in {row.rounds} rounds"
    if not 0 <= row.retries <= sum(map(len, row.outcomes)):
        yield f"retries: {row.retries} in {row.rounds} rounds"
    if len(row.exchanges) != min(row.usage.calls, EXCHANGES_MAX):
        yield f"usage: {row.usage.calls} calls, {len(row.exchanges)} exchanges"
    if len(row.exchanges) == row.usage.calls:
        yield from _wrong_usage(row)


def _wrong_usage(row: Record) -> Iterator[str]:
    """Tokens and money against the exchanges they are of, where all of these are there."""
    tokens = sum(exchange.tokens for exchange in row.exchanges)
    if tokens != row.usage.prompt_tokens + row.usage.completion_tokens:
        yield f"usage: recorded {row.usage}, {tokens} tokens in its exchanges"
    money = sum(exchange.money or 0.0 for exchange in row.exchanges)
    if abs(money - row.usage.money) > 1e-9:
        yield f"usage: recorded {row.usage.money} dollars, {money} in its exchanges"
    if any(exchange.money is None and exchange.error is None for exchange in row.exchanges) and not row.usage.unpriced:
        yield "usage: every request has a price, and of an exchange none is told"


def _readers(row: Record, job: Job) -> dict[str, Any]:
    """The roles of our own that read the truth and the rules, and whether code from outside was kept apart."""
    from remac_agents.roles.grants import reads_rules, reads_truth, weights

    if row.error is not None:
        return {}
    others = _of_others(job)
    known = replace(job, agent={name: value for name, value in job.agent.items() if name not in (*others, "model")})
    roles = {name: role for name, role in make(known, {}).roles.named().items() if name not in others}  # type: ignore[attr-defined]
    found: dict[str, Any] = {}
    for field, reads in (("truth_readers", reads_truth), ("rule_readers", reads_rules)):
        told = getattr(row, field)
        of_others = [name for name in told if name in others]
        ours = [name for name, role in roles.items() if reads(role)]
        found[field] = told if sorted(told) == sorted([*ours, *of_others]) else [*ours, *of_others]
    found["weights"] = {name: digest for name, digest in row.weights.items() if name in others} | weights(roles)
    outside = plugins(job.agent, providers=job.access.providers)
    return found | ({"isolated": job.access.isolated} if outside else {} if others else {"isolated": None})


def _of_others(job: Job) -> list[str]:
    """The roles that are not our own."""
    from remac_agents.wiring.catalogue import ROLES

    given = {role: str(job.agent[role]).partition(",")[0] for role in agents.ROLES if role in job.agent}
    others = [role for role, name in given.items() if name not in ROLES[role] or name == agents.PERSON]
    if "model" in job.agent:
        # A model fills them, and one without eyes is given a checker that knows: its provider's page says which.
        others += [role for role in agents.ROLES if role not in given]
    return others


def _wrong_words(row: Record, job: Job) -> Iterator[str]:
    """What is told of models that were never asked, of robots that are not there, and of a checker that knows."""
    from remac_agents.checkers.truth import UNSEEN
    from remac_agents.wiring.filling import DEFAULTS

    planner = str(job.agent.get("planner", job.agent.get("model", ""))).partition(",")[0]
    asked = agents.is_model(planner, job.access.providers)
    if asked and row.error is None and row.outcomes and not row.usage.calls + row.usage.repeats:
        yield f"usage: {planner} planned {row.rounds} rounds, and was asked nothing"
    knows = "checker" not in _of_others(job) and job.agent.get("checker", DEFAULTS["checker"]) == "truth"
    robots = row.worlds[0].get("robots", {}) if row.worlds else {}
    for check in (*row.pre_checks, *row.post_checks):
        if check.robot not in robots:
            yield f"checks: nobody is called {check.robot!r}"
        if knows and check.verdict != check.truth and check.reason != UNSEEN:
            yield f"checks: {check.verdict} of what is {check.truth}, by a checker that knows: {check.condition!r}"
