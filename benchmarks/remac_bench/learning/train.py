"""Trains a network on demonstrations, with torch: chunks of commands, relative to where the robot is.

A single next command does not do: scripted motion pauses, and a policy of single steps never leaves a pause. Frames in
which the command does not change are left out for the same reason.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from remac_bench.errors import UsageError
from remac_bench.learning.demos import Demo, Numbers
from remac_env.backends.physics.controllers.learned.hand import hands
from remac_env.backends.physics.controllers.learned.network import HAND, Network
from remac_env.backends.physics.controllers.learned.seen import entries, overlooked
from remac_env.backends.physics.controllers.learned.weights import bag
from remac_env.robots import bodies
from remac_env.rules.skills import SKILLS
from remac_env.seeding import digest

_TURN, _ROUND = 2, 2.0 * np.pi  # the heading among a command's numbers, and a whole turn, rad
_ARM = 3  # from where on a command's numbers are about lift, arm and fingers
_AFTER = 24  # frames that are shown after an object was taken or put, while the hand goes clear
_MOVED = 2e-4  # rad or m by which a command differs from the one before it where it counts as motion
_LITTLE = 1e-3  # added to deviations: of numbers that hardly vary
THREADS = 1
"""Threads that networks are trained with on every machine: the last bits of torch's sums depend on their number, and
on a busy machine several spin while they wait for each other.
"""

_BLIND = 1e9  # the deviation by which numbers are divided that are not to be looked at: nothing is left of them


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """How a network is trained.

    Attributes:
        width, depth: units of a hidden layer, and how many of these there are.
        chunk, execute: commands predicted at once, and carried out before the next observation.
        epochs: passes over the demonstrations. batch: frames a step. rate: largest step size (AdamW, one cycle).
        jitter: standard deviation of what is added to normalised observations.
        hand: whether commands say where the hand is to be, too.
        seed: of the first weights and the order of frames.
    """

    width: int = 384
    depth: int = 3
    chunk: int = 16
    execute: int = 8
    epochs: int = 60
    batch: int = 256
    rate: float = 1e-3
    jitter: float = 0.02
    hand: bool = False
    seed: int = 0


@dataclass(frozen=True, eq=False)
class Frames:
    """What a network learns from: observations (N, n) and commands that follow (N, chunk, m), see `Network`.

    ``overlooked``: numbers of an observation that it is not to look at.
    """

    seen: Numbers
    wanted: Numbers
    overlooked: Sequence[int] = ()


def torch() -> Any:
    """The library that trains.

    Raises:
        UsageError: where it is not installed; it says how to install it.
    """
    try:
        return importlib.import_module("torch")
    except ImportError as error:
        raise UsageError("training needs torch; install it: pip install 'remac-kitchen[learn]'") from error


@contextmanager
def fixed_threads() -> Iterator[None]:
    """Let torch use as many threads as it does anywhere, for now.

    Raises:
        UsageError: where torch is not installed.
    """
    library = torch()
    before = library.get_num_threads()
    library.set_num_threads(THREADS)
    try:
        yield
    finally:
        library.set_num_threads(before)


def code_digest() -> str:
    """A name for the code that decides what is learnt: recording, training, and what is seen."""
    here = Path(__file__).parent
    learned = Path(entries.__code__.co_filename).parent
    seen = (learned / f"{name}.py" for name in ("aim", "aims", "drive", "hand", "seen", "stand"))
    files = [here / "record.py", here / "train.py", *seen]
    return digest([path.read_text("utf-8") for path in files])


def words_of(demos: Iterable[Demo]) -> tuple[str, ...]:
    """The words of their commands."""
    return tuple(sorted({word for demo in demos for word in demo.command.split()}))


def frames(demos: Iterable[Demo], chunk: int, words: Sequence[str] = (), *, hand: bool = False) -> Frames:
    """The frames of demonstrations in which something moves.

    ``words``: of commands, shown behind observations. ``hand``: say where the hand is to be, too. All are of one body.
    """
    seen, wanted, blind = [], [], set[int]()
    for demo in demos:
        blind.update(overlooked(SKILLS[demo.skill], demo.body))
        moved = np.abs(np.diff(demo.commands, axis=0)).max(axis=1) > _MOVED
        moves = np.flatnonzero(np.concatenate([[True], moved]))
        moves = np.append(moves, len(demo.commands) - 1)
        shown = moves[moves < _ends(demo)]
        commands, start = demo.commands[moves], np.append(demo.measured[shown], np.zeros((len(shown), 1)), axis=1)
        if hand:
            at = demo.observations[:-1, _hand_of(demo)][moves]
            commands = np.concatenate([commands, hands(commands, bodies.get(demo.body))], axis=1)
            start = np.concatenate([start, at[: len(shown)], np.zeros((len(shown), HAND - 3))], axis=1)
        following = np.minimum(np.arange(len(shown))[:, None] + np.arange(chunk), len(moves) - 1)
        said = np.tile(bag(words, demo.command), (len(shown), 1))
        seen.append(np.concatenate([demo.observations[shown], said], axis=1))
        change = commands[following] - start[:, None]
        change[..., _TURN] -= _ROUND * np.rint(change[..., _TURN] / _ROUND)  # headings are told within half a turn
        if SKILLS[demo.skill].moves:
            change[..., _ARM:] = 0.0  # it stays as it is, and nobody asks what a drive says of it
        wanted.append(change)
    return Frames(np.concatenate(seen), np.concatenate(wanted).astype(np.float32), sorted(blind))


def _hand_of(demo: Demo) -> list[int]:
    """Which numbers of its observation say where the hand is."""
    names = [entry.name for entry in entries(SKILLS[demo.skill], demo.body)]
    return [names.index(f"hand_{axis}") for axis in "xyz"]


def _ends(demo: Demo) -> int:
    """The frame from which on nothing is learnt: what is taken or put is so, and policies end soon after that."""
    row, done = SKILLS[demo.skill], np.flatnonzero(demo.rewards > 0.0)
    return int(done[0]) + _AFTER if (row.takes or row.puts) and len(done) else len(demo.commands)


@fixed_threads()
def train(data: Frames, recipe: Recipe, *, report: Any = lambda epoch, loss: None) -> Network:
    """A network that says what the demonstrations did. ``report`` is told of each epoch."""
    library = torch()
    library.manual_seed(recipe.seed)
    mean, std = data.seen.mean(axis=0), data.seen.std(axis=0) + _LITTLE
    std[list(data.overlooked)] = _BLIND
    out_mean, out_std = data.wanted.mean(axis=0), data.wanted.std(axis=0) + _LITTLE
    inputs = library.from_numpy(((data.seen - mean) / std).astype(np.float32))
    outputs = library.from_numpy(((data.wanted - out_mean) / out_std).astype(np.float32)).flatten(1)
    net = _layers(library, inputs.shape[1], outputs.shape[1], recipe)
    place = library.device("cuda" if library.cuda.is_available() else "cpu")
    net, inputs, outputs = net.to(place), inputs.to(place), outputs.to(place)
    steps = max(1, len(inputs) // recipe.batch)
    optimiser = library.optim.AdamW(net.parameters(), lr=recipe.rate, weight_decay=1e-4)
    schedule = library.optim.lr_scheduler.OneCycleLR(
        optimiser, recipe.rate, total_steps=recipe.epochs * steps + 1, pct_start=0.1
    )
    for epoch in range(recipe.epochs):
        order, total = library.randperm(len(inputs), device=place), 0.0
        for part in order[: steps * recipe.batch].chunk(steps):
            shown = inputs[part]
            loss = (net(shown + recipe.jitter * library.randn_like(shown)) - outputs[part]).abs().mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()
            total += loss.item()
        report(epoch, total / steps)
    return _as_numbers(net, mean, std, out_mean, out_std)


def _layers(library: Any, inputs: int, outputs: int, recipe: Recipe) -> Any:
    parts, size = [], inputs
    for _ in range(recipe.depth):
        parts += [library.nn.Linear(size, recipe.width), library.nn.LayerNorm(recipe.width), library.nn.ReLU()]
        size = recipe.width
    return library.nn.Sequential(*parts, library.nn.Linear(size, outputs))


def _as_numbers(net: Any, mean: Numbers, std: Numbers, out_mean: Numbers, out_std: Numbers) -> Network:
    found = [part for part in net.cpu() if hasattr(part, "weight")]
    arrays = [(part.weight.detach().numpy(), part.bias.detach().numpy()) for part in found]
    layers = tuple((*arrays[number], *arrays[number + 1]) for number in range(0, len(arrays) - 1, 2))
    return Network(
        mean.astype(np.float32), std.astype(np.float32), layers, arrays[-1], out_mean.astype(np.float32),
        out_std.astype(np.float32),
    )  # fmt: skip


def check_sizes(recipe: Recipe) -> None:
    """Refuse a recipe that makes no network; UsageError."""
    for name in ("width", "depth", "chunk", "execute", "epochs", "batch"):
        if getattr(recipe, name) < 1:
            raise UsageError(f"{name} {getattr(recipe, name)} is not valid; valid: 1 or more")
    if recipe.execute > recipe.chunk:
        raise UsageError(f"execute {recipe.execute} is not valid; valid: 1..{recipe.chunk}, the chunk")
