"""Trains the network of a checker that sees, with torch: to answer true, false or hidden to questions about pictures.

Frequent questions and answers are put less often than they come, rare ones more. Pictures are mirrored, moved and
coloured: nothing that is asked hangs on left and right, on lamps or on where exactly a camera stands.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_agents.vision.network import ANSWERS, CAMERAS, CELLS, HEADS, STRIDES, Network, Words, shapes
from remac_agents.vision.questions import MOST_NAMES, predicates, words_of
from remac_bench.errors import UsageError
from remac_bench.learning.checker_files import Album, answers
from remac_bench.learning.train import fixed_threads, torch

Codes = NDArray[np.int64]

_LONGEST_NAME = 3  # words of a name that are told
_OFTEN = 0.15  # of the episodes: in as many a name was met often
_ASKED, _SOMETIMES = 8.0, 3.0  # times as often as others what methods ask now is put, and what they ask elsewhere
_SOME = 0.2  # asked as many times as there are episodes times this, or more: it is asked elsewhere
_MOVED = 4  # pixels, at most
_LEFT_OUT = 0.2  # of the features of the whole, by chance, while it learns
_EPSILON = 1e-5  # of batch normalisation, as in torch


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """How a network is trained.

    Attributes:
        channels: of the convolutions. asked: width of an embedded question. hidden: units before the answers. whole:
            features of the whole.
        epochs: passes over the pictures. batch: views a step. questions: put to each view at a time.
        rate: largest step size (AdamW, one cycle). seed: of first weights and of what is drawn.
    """

    channels: tuple[int, ...] = (16, 24, 48, 64, 64, 64)
    asked: int = 96
    hidden: int = 128
    whole: int = 160
    epochs: int = 20
    batch: int = 16
    questions: int = 40
    rate: float = 3e-3
    seed: int = 0


def words_in(album: Album) -> Words:
    """Everything that an album asks about."""
    used = np.unique(album.rows[:, 2:4])
    names = [album.texts[number] for number in used if album.texts[number]]
    return Words(predicates(), tuple(sorted({word for name in names for word in words_of(name)})))


def common_in(album: Album) -> tuple[str, ...]:
    """The words of the names about which many of an album's episodes ask."""
    seeds = np.tile(album.view_facts[album.rows[:, 0], 0], 2)
    met = np.unique(np.stack([seeds, album.rows[:, 2:4].T.ravel()]), axis=1)[1]
    often = [number for number, count in zip(*np.unique(met, return_counts=True), strict=True)
             if album.texts[number] and count >= _OFTEN * len(album.seeds)]  # fmt: skip
    return tuple(sorted({word for number in often for word in words_of(album.texts[number])}))


def codes(album: Album, words: Words) -> tuple[Codes, NDArray[np.bool_]]:
    """What each row asks, as numbers of embeddings, (m, 1 + (MOST_NAMES + 1) * _LONGEST_NAME), and whether it is known.

    Places that are left, and unknown words of what is held, have the number after the last embedding.
    """
    width, start = len(words.words), len(words.predicates)
    nothing = start + (MOST_NAMES + 1) * width
    names = np.full((MOST_NAMES + 1, len(album.texts), _LONGEST_NAME), nothing, np.int64)
    known = np.ones(len(album.texts), bool)
    for index, text in enumerate(album.texts):
        for part, word in enumerate(words_of(text)[:_LONGEST_NAME] if text else ()):
            if word not in words.words:
                known[index] = False
                continue
            for place in range(MOST_NAMES + 1):
                names[place, index, part] = start + place * width + words.words.index(word)
    asked = np.array([words.predicates.index(t) if t in words.predicates else -1 for t in album.texts], np.int64)
    rows = album.rows
    held = album.view_facts[rows[:, 0], 1]
    found = [asked[rows[:, 1]][:, None], names[0][rows[:, 2]], names[1][rows[:, 3]], names[2][held]]
    fine = known[rows[:, 2]] & known[rows[:, 3]] & (asked[rows[:, 1]] >= 0)
    return np.concatenate(found, axis=1), fine


def shares(album: Album, asked: Codes, fine: NDArray[np.bool_]) -> NDArray[np.float64]:
    """How often each row is to be put: the rarer its predicate, with where it is asked of and its answer, the more.

    What methods ask, and what they ask at other moments, is put more often than what nobody asks.
    """
    last = np.where(album.rows[:, 3] > 0, album.rows[:, 3], album.rows[:, 2])
    kinds = (asked[:, 0] * len(album.texts) + last) * len(ANSWERS) + answers(album)
    _, kinds = np.unique(kinds, return_inverse=True)
    often = np.bincount(kinds[fine], minlength=kinds.max() + 1).astype(float)
    _, questions = np.unique(album.rows[:, 1:4], axis=0, return_inverse=True)
    now = album.rows[:, 6] == 1
    sometimes = np.bincount(questions.ravel(), now)[questions.ravel()] >= _SOME * len(album.seeds)
    share = np.select([now, sometimes], [_ASKED, _SOMETIMES], 1.0) / np.sqrt(np.maximum(often[kinds], 1.0))
    return np.where(fine, share, 0.0)


@fixed_threads()
def train(
    album: Album, recipe: Recipe, *, report: Callable[[int, float], None] = lambda epoch, loss: None
) -> Network:
    """A network that answers as the album says. ``report`` is told of each epoch.

    Raises:
        UsageError: where torch is not installed, or there are fewer views than a step takes.
    """
    library = torch()
    if len(album.station) < recipe.batch:
        raise UsageError(f"{len(album.station)} views are too few to learn from; valid: {recipe.batch} or more")
    library.manual_seed(recipe.seed)
    chance = np.random.default_rng(recipe.seed)
    words = words_in(album)
    asked, fine = codes(album, words)
    share, right = shares(album, asked, fine), answers(album)
    first = np.searchsorted(album.rows[:, 0], np.arange(len(album.station) + 1))
    parts = _parts(library, words, recipe)
    tuned = [array for part in parts.values() for array in part.parameters()]
    optimiser = library.optim.AdamW(tuned, lr=recipe.rate, weight_decay=1e-3)
    steps = len(album.station) // recipe.batch
    schedule = library.optim.lr_scheduler.OneCycleLR(
        optimiser, recipe.rate, total_steps=recipe.epochs * steps + 1, pct_start=0.2
    )
    for epoch in range(recipe.epochs):
        order, total = chance.permutation(len(album.station)), 0.0
        for step in range(steps):
            views = order[step * recipe.batch : (step + 1) * recipe.batch]
            put = np.stack([_drawn(chance, share[first[v] : first[v + 1]], recipe.questions) + first[v] for v in views])
            pictures = _varied(library, chance, album, views)
            logits = _forward(library, parts, pictures, library.from_numpy(asked[put]))
            loss = library.nn.functional.cross_entropy(
                logits.flatten(0, 1), library.from_numpy(right[put]).flatten(), label_smoothing=0.02
            )
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()
            total += loss.item()
        report(epoch, total / steps)
    return _as_network(words, parts)


def _drawn(chance: np.random.Generator, share: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """So many rows of a view, by their shares; some twice where there are fewer."""
    with np.errstate(divide="ignore"):
        keys = np.log(share) + chance.gumbel(size=len(share))
    best = np.argsort(-keys)[: min(count, int((share > 0.0).sum()))]
    return np.resize(best, count)


def _varied(library: Any, chance: np.random.Generator, album: Album, views: NDArray[np.int64]) -> dict[str, Any]:
    """The pictures of views, (n, 3, SIZE, SIZE) about 0, each batch moved and each view mirrored and coloured."""
    mirrored = chance.random(len(views)) < 0.5
    found = {}
    for camera in CAMERAS:
        values = getattr(album, camera)[views].astype(np.float32) / 255.0 - 0.5
        values[mirrored] = values[mirrored, :, ::-1]
        gain = chance.uniform(0.75, 1.25, (len(views), 1, 1, 1)) * chance.uniform(0.9, 1.1, (len(views), 1, 1, 3))
        shift = chance.uniform(-0.1, 0.1, (len(views), 1, 1, 1)) + chance.uniform(-0.04, 0.04, (len(views), 1, 1, 3))
        moved = np.roll(values, tuple(chance.integers(-_MOVED, _MOVED + 1, 2)), axis=(1, 2))
        varied = np.ascontiguousarray(moved * gain + shift, dtype=np.float32)
        found[camera] = library.from_numpy(varied).permute(0, 3, 1, 2)  # channels stay last in memory: a third quicker
    return found


def _parts(library: Any, words: Words, recipe: Recipe) -> dict[str, Any]:
    nn, sizes = library.nn, shapes(words, recipe.channels, recipe.asked, recipe.hidden, recipe.whole)
    count, width = sizes["embedding"]
    found: dict[str, Any] = {
        "embedding": nn.EmbeddingBag(count + 1, width, mode="sum", padding_idx=count),
        "bias": nn.ParameterList([nn.Parameter(library.zeros(width))]),
        "hidden": nn.Linear(sizes["hidden"][1], sizes["hidden"][0]), "last": nn.Linear(recipe.hidden, len(ANSWERS)),
    }  # fmt: skip
    found |= {
        "whole": nn.Linear(sizes["whole"][1], recipe.whole), "gate": nn.Linear(width, recipe.whole, bias=False)
    }  # fmt: skip
    nn.init.normal_(found["embedding"].weight, std=0.3)
    for camera in CAMERAS:
        size = 3
        layers: list[Any] = []
        for out, stride in zip(recipe.channels, STRIDES, strict=True):
            layers += [nn.Conv2d(size, out, 3, stride, 1, bias=False), nn.BatchNorm2d(out), nn.ReLU()]
            size = out
        found[camera] = nn.Sequential(*layers).to(memory_format=library.channels_last)
        found[f"{camera}_places"] = nn.ParameterList([nn.Parameter(0.1 * library.randn(sizes[f"{camera}_places"]))])
        found[f"{camera}_asks"] = nn.Linear(width, sizes[f"{camera}_asks"][0], bias=False)
    return found


def _forward(library: Any, parts: Mapping[str, Any], pictures: Mapping[str, Any], asked: Any) -> Any:
    """Logits (views, questions, 3) for pictures (views, 3, SIZE, SIZE) and codes (views, questions, k)."""
    views, count = asked.shape[:2]
    told = library.relu(parts["embedding"](asked.flatten(0, 1)) + parts["bias"][0]).unflatten(0, (views, count))
    found, last = [told], []
    for camera in CAMERAS:
        near = parts[camera][: 3 * CELLS](pictures[camera])
        last.append(parts[camera][3 * CELLS :](near).flatten(1))
        cells = near.flatten(2).transpose(1, 2) + parts[f"{camera}_places"][0]
        wanted = parts[f"{camera}_asks"](told).unflatten(2, (HEADS, -1)).flatten(1, 2)
        share = library.softmax(wanted @ cells.transpose(1, 2) / cells.shape[2] ** 0.5, dim=-1)
        found.append((share @ cells).unflatten(1, (count, HEADS)).flatten(2))
    far = library.nn.functional.dropout(library.cat(last, dim=1), _LEFT_OUT, parts["whole"].training)
    whole = library.relu(parts["whole"](far))
    found.append(whole[:, None] * parts["gate"](told))
    return parts["last"](library.relu(parts["hidden"](library.cat(found, dim=2))))


def _as_network(words: Words, parts: Mapping[str, Any]) -> Network:
    """The arrays, with normalisation worked into the convolutions."""
    def numbers(array: Any) -> NDArray[np.float32]:
        return np.asarray(array.detach().numpy(), np.float32)

    arrays = {"embedding": numbers(parts["embedding"].weight)[:-1], "embedding_bias": numbers(parts["bias"][0])}
    arrays["gate"] = numbers(parts["gate"].weight)
    for name in ("hidden", "last", "whole"):
        arrays |= {name: numbers(parts[name].weight), f"{name}_bias": numbers(parts[name].bias)}
    for camera in CAMERAS:
        layers = list(parts[camera])
        for number, (conv, norm) in enumerate(zip(layers[::3], layers[1::3], strict=True)):
            gain = numbers(norm.weight) / np.sqrt(numbers(norm.running_var) + _EPSILON)
            weights = numbers(conv.weight).reshape(len(gain), -1)
            arrays[f"{camera}_weight_{number}"] = weights * gain[:, None]
            arrays[f"{camera}_bias_{number}"] = numbers(norm.bias) - numbers(norm.running_mean) * gain
        arrays[f"{camera}_places"] = numbers(parts[f"{camera}_places"][0])
        arrays[f"{camera}_asks"] = numbers(parts[f"{camera}_asks"].weight)
    return Network(words, arrays)
