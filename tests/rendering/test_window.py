"""render_mode="human" without a display, and with one where there is one."""

from __future__ import annotations

import logging
import os
import sys

import mujoco
import pytest

from remac_env.rendering.window import Window

MODEL = '<mujoco><worldbody><camera name="eye" pos="0 -2 1"/><geom size="0.1"/></worldbody></mujoco>'


@pytest.fixture
def ball() -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = mujoco.MjModel.from_xml_string(MODEL)
    return model, mujoco.MjData(model)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="displays are named by DISPLAY on Linux alone")
@pytest.mark.parametrize("display", [None, ":9999"])
def test_without_a_display_it_says_so_once_and_shows_nothing(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, ball, display: str | None
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    if display is not None:
        monkeypatch.setenv("DISPLAY", display)
    with caplog.at_level(logging.WARNING):
        window = Window()
        for _ in range(3):
            window.show(*ball, "eye")
        window.close()
        window.close()
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    assert "display" in caplog.text and "human" in caplog.text


@pytest.mark.skipif(not os.environ.get("DISPLAY"), reason="no display")
def test_with_a_display_the_viewer_shows_the_model_from_the_camera(caplog: pytest.LogCaptureFixture, ball) -> None:
    window = Window()
    window.show(*ball, "eye")
    assert not caplog.records
    viewer = window._viewer
    assert viewer.is_running() and viewer.cam.fixedcamid == 0
    window.show(*ball, "eye")
    assert window._viewer is viewer
    window.close()
    assert not viewer.is_running()
