"""What `remac learn record` writes, read and learnt from by lerobot and robomimic: `make loaders` installs them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_demos import made
from remac_bench.learning.demos import Demo, write_shard
from remac_bench.learning.lerobot import Dataset

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def torch() -> Any:
    """PyTorch, beside which torchvision can be imported.

    torchvision's wheel is for a torch with CUDA. Of what it defines itself, two operators are looked for on import.
    """
    library = pytest.importorskip("torch", reason="make loaders installs it")
    defined = library.library.Library("torchvision", "FRAGMENT")
    for name in ("nms", "qnms"):
        if not hasattr(library.ops.torchvision, name):
            defined.define(f"{name}(Tensor dets, Tensor scores, float iou_threshold) -> Tensor")
    library.set_num_threads(1)
    yield library
    del defined


@pytest.fixture
def lerobot(torch: Any) -> Any:
    """The module of lerobot's loader; frames of videos are decoded by PyAV, as torchcodec needs CUDA's torch."""
    pytest.importorskip("lerobot", reason="make loaders installs it")
    from lerobot.datasets import lerobot_dataset

    return lerobot_dataset


def decoded(path: Path, times: list[float], tolerance: float, backend: str) -> Any:
    """As lerobot decodes frames: those at these times, (n, channels, height, width), 0 to 1."""
    import av
    import torch

    with av.open(str(path)) as file:
        frames = [(float(each.pts * each.time_base), each.to_ndarray(format="rgb24")) for each in file.decode(video=0)]
    found = []
    for time in times:
        at, frame = min(frames, key=lambda each: abs(each[0] - time))
        assert abs(at - time) < tolerance, (at, time)
        found.append(torch.from_numpy(frame).permute(2, 0, 1) / 255.0)
    return torch.stack(found)


@pytest.mark.parametrize("videos", [True, False])
def test_lerobot_reads_what_we_write(
    videos: bool, lerobot: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    monkeypatch.setenv("HF_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(lerobot, "decode_video_frames", decoded)
    demos = [made(30, seed=1, size=32), made(20, seed=2, size=32, skill="turn off", target="stove")]
    written = Dataset(tmp_path / "demos", videos=videos, language=False)
    written.add("one", demos)
    written.add("two", demos[:1])
    read = lerobot.LeRobotDataset("remac/demos", root=tmp_path / "demos", delta_timestamps={"action": [0.0, 0.05]})
    assert (len(read), read.num_episodes, read.fps) == (80, 3, 20)
    row, last = read[35], read[79]
    assert (row["task"], row["subtask"], last["task"]) == ("turn off stove", "turn off stove", "turn on faucet")
    assert np.array_equal(row["action"].numpy(), demos[1].actions[5:7])
    assert np.array_equal(row["observation.state"].numpy(), demos[1].observations[5])
    assert bool(last["next.done"]) and not bool(row["next.done"]) and last["action_is_pad"].tolist() == [False, True]
    shown = 255.0 * row["observation.images.front"].permute(1, 2, 0).numpy()
    wanted = demos[1].pictures["front"][5][:12, :12].astype(float)
    assert np.abs(shown[:12, :12] - wanted).mean() < (8.0 if videos else 0.01)
    assert read.meta.stats["observation.images.front"]["mean"].shape == (3, 1, 1)
    assert read.meta.stats["action"]["q99"].shape == (12,)


def test_the_language_columns_are_those_of_lerobots_schema(tmp_path: Path) -> None:
    datasets = pytest.importorskip("datasets", reason="make loaders installs it")
    Dataset(tmp_path).add("one", [made()])
    text = datasets.Value("string")
    calls = datasets.List(datasets.Json() if hasattr(datasets, "Json") else text)
    event = {"role": text, "content": text, "style": text, "camera": text, "tool_calls": calls}
    row = event | {"timestamp": datasets.Value("float32")}
    wanted = {"language_persistent": datasets.List(row), "language_events": datasets.List(event)}
    path = str(tmp_path / "data/chunk-000/file-000.parquet")
    columns = datasets.Dataset.from_parquet(path, columns=list(wanted), features=datasets.Features(wanted))
    said = columns[0]["language_persistent"]
    assert [each["style"] for each in said] == ["subtask", "plan", "memory", "memory"]
    assert columns[0]["language_events"] == []


KINDS = {"low_dim": ["state"], "rgb": ["front_image"]}


def robomimics(folder: Path, demos: list[Demo], length: int) -> Any:
    """What robomimic's loader makes of demonstrations: sequences of so many steps."""
    pytest.importorskip("h5py", reason="make loaders installs it")
    kinds = pytest.importorskip("robomimic.utils.obs_utils", reason="make loaders installs it")
    from robomimic.utils.dataset import SequenceDataset

    path = folder / "TurnOn_000000.hdf5"
    write_shard(path, demos)
    kinds.initialize_obs_utils_with_obs_specs({"obs": KINDS})
    return SequenceDataset(
        hdf5_path=str(path), obs_keys=["state", "front_image"], dataset_keys=("actions", "rewards", "dones"),
        seq_length=length, hdf5_cache_mode=None, hdf5_use_swmr=False, load_next_obs=True, filter_by_attribute="train",
    )  # fmt: skip


def test_robomimic_reads_what_we_write(torch: Any, tmp_path: Path) -> None:
    demos = [made(30, seed=1, size=32), made(20, seed=2, size=32)]
    read = robomimics(tmp_path, demos, 3)
    row = read[5]
    assert np.allclose(row["actions"], demos[0].actions[5:8])
    assert np.allclose(row["obs"]["state"], demos[0].observations[5:8])
    assert np.allclose(row["next_obs"]["state"], demos[0].observations[6:9])
    assert row["obs"]["front_image"].shape == (3, 32, 32, 3)
    assert len(read) == 50


def test_a_resnet_with_a_mixture_of_gaussians_learns_from_our_pictures(torch: Any, tmp_path: Path) -> None:
    """The paper's policy, as robomimic has it; how well it does is not asked here."""
    read = robomimics(tmp_path, [made(30, seed=1, size=64)], 1)
    from robomimic.algo import algo_factory
    from robomimic.config import config_factory

    config = config_factory("bc")
    with config.values_unlocked():
        config.observation.modalities.obs.low_dim, config.observation.modalities.obs.rgb = KINDS.values()
        seeing = config.observation.encoder.rgb
        seeing.core_class, seeing.core_kwargs.backbone_class = "VisualCore", "ResNet18Conv"
        seeing.core_kwargs.pool_class, seeing.core_kwargs.feature_dimension = "SpatialSoftmax", 64
        config.algo.gmm.enabled = True
    shapes = {"state": list(read[0]["obs"]["state"].shape[1:]), "front_image": [3, 64, 64]}
    made_of = algo_factory("bc", config, obs_key_shapes=shapes, ac_dim=12, device=torch.device("cpu"))
    losses = []
    for epoch in range(3):
        for batch in torch.utils.data.DataLoader(read, batch_size=8):
            shown = made_of.postprocess_batch_for_training(made_of.process_batch_for_training(batch), None)
            losses.append(float(made_of.train_on_batch(shown, epoch)["losses"]["action_loss"]))
    assert np.isfinite(losses).all() and np.mean(losses[-4:]) < np.mean(losses[:4])
    made_of.set_eval()
    seen = {"state": torch.zeros(1, *shapes["state"]), "front_image": torch.zeros(1, 3, 64, 64)}
    assert made_of.get_action(seen).shape == (1, 12)
