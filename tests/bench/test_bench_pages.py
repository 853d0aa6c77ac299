"""Pages: the report's numbers, links that lead somewhere, hostile text as text. Each check sees a planted fault."""

from __future__ import annotations

import shlex
from pathlib import Path

import cv2
import pytest
from bench_helpers import record
from pages_helpers import EVIL, Element, alien, hostile, parse, real_run, spoken
from remac_bench.blame.labels import Blame
from remac_bench.blame.sheet import blame_sheets, write_blames
from remac_bench.board import Board, Cell, Column, Sheet
from remac_bench.cli import app
from remac_bench.judging.grades import made_from
from remac_bench.pages import write_pages
from remac_bench.pages.episode_page import PAGE_MAX, page, page_name
from remac_bench.pages.pictures import lay_out, paint
from remac_bench.pages.plots import scatter
from remac_bench.pages.rounds import changes, round_spans
from remac_bench.pages.text import visible
from remac_bench.records import ExchangeEntry, OutcomeEntry, UsageEntry, VideoEntry
from remac_bench.report import read_board, read_records
from remac_bench.store import Store
from typer.testing import CliRunner

DASH = Cell(text="-")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = real_run(tmp_path_factory.mktemp("run"))
    Store(folder).append([spoken(folder)])
    write_pages(folder)
    return folder


def leaderboard(folder: Path) -> str:
    return (folder / "leaderboard.html").read_text("utf-8")


def differences(html: str, board: Board) -> list[str]:
    """Where the tables of a page are not those of a board: every cell by what it shows and by the number behind it."""
    found, root = [], parse(html)
    for sheet in board.sheets:
        (table,) = root.all("table", **{"data-sheet": sheet.key})
        keys = [head.attributes["data-key"] for head in table.all("th")]
        rows = table.all("tbody")[0].all("tr")
        if len(rows) != len(sheet.rows) or {key for row in sheet.rows for key in row} - set(keys):
            found.append(f"{sheet.key}: {len(rows)} rows, {keys}")
        for line, row in zip(rows, sheet.rows, strict=False):
            for key, cell in zip(keys, line.all("td"), strict=True):
                told = row.get(key, DASH)
                text = cell.all("bdi")[0].text
                number = cell.attributes.get("data-value")
                if text != told.text or (told.value is not None and float(number or "nan") != told.value):
                    found.append(f"{sheet.key} {key}: {text} ({number}) for {told}")
    return found


def dead_links(folder: Path, path: Path) -> list[str]:
    """Links and sources of a page that lead nowhere."""
    root = parse(path.read_text("utf-8"))
    names = {each.attributes.get("id") for each in root.walk()}
    dead = []
    for each in root.walk():
        target = each.attributes.get("href") or each.attributes.get("src")
        if target is None:
            continue
        file, _, fragment = target.partition("#")
        if file and not (path.parent / file).is_file():
            dead.append(target)
        if not file and fragment not in names:
            dead.append(target)
    return dead


def test_tables_are_the_reports(run: Path) -> None:
    board = read_board(run)
    assert len(board.sheets) >= 5
    assert differences(leaderboard(run), board) == []
    assert differences(leaderboard(run).replace('<bdi class="cell">100%', '<bdi class="cell">99%', 1), board)
    assert differences(leaderboard(run).replace('data-value="1.0"', 'data-value="0.9"', 1), board)


def test_every_link_leads_somewhere(run: Path) -> None:
    pages = [run / "leaderboard.html", *(run / "episodes").iterdir()]
    assert len(pages) == 1 + len(read_records(run))
    assert {path.name: dead_links(run, path) for path in pages if dead_links(run, path)} == {}
    for sheet in read_board(run).sheets:
        assert (run / "tables" / f"{sheet.key}.svg").is_file()
        assert cv2.imread(str(run / "tables" / f"{sheet.key}.png")).shape[2] == 3
    bad = run / "episodes" / "bad.html"
    bad.write_text('<a href="#round-3">x</a><img src="../no.png">', "utf-8")
    assert dead_links(run, bad) == ["#round-3", "../no.png"]
    bad.unlink()


def test_own_pages_are_clean_and_the_check_sees_what_is_not(run: Path) -> None:
    for path in [run / "leaderboard.html", *(run / "episodes").iterdir()]:
        assert alien(path.read_text("utf-8")) == [], path.name
    faults = ["<script>1</script>", '<i onclick="x">', '<a href="https://example.org/">', '<p style="x">']
    for fault in (*faults, "\u202e", "\x1b"):
        assert alien(leaderboard(run).replace("</main>", f"{fault}</main>")), fault


def test_hostile_text_is_shown_as_text(tmp_path: Path) -> None:
    evil = hostile()
    Store(tmp_path).append([evil, record(job="calm")])
    texts = dict.fromkeys(("setting", "task", "agent", "method", "what"), EVIL)
    write_blames(tmp_path, [Blame(job=evil.job, iteration=0, seed=0, label="planner", round=0, **texts)])
    write_pages(tmp_path)
    files = [tmp_path / "leaderboard.html", *(tmp_path / "episodes").iterdir()]
    assert len(files) == 3 and all(path.resolve().is_relative_to(tmp_path.resolve()) for path in files)
    for path in files:
        assert alien(path.read_text("utf-8")) == [], path.name
    html = (tmp_path / "episodes" / page_name(evil)).read_text("utf-8")
    shown = parse(html).text
    assert '<script>document.title="owned"</script>' in shown and "\u241b[31m\u27e8U+202E\u27e9abc\u2400" in shown
    assert "{{7*7}}" in shown and "example.org" not in html
    for picture in (tmp_path / "tables").glob("*.svg"):
        assert "<script" not in picture.read_text("utf-8")
    assert alien(html.replace("&lt;script&gt;", "<script>"))


@pytest.mark.parametrize(
    ("text", "seen"),
    [
        ("plain\ttext\n", "plain\ttext\n"),
        ("\x00\x1b\x7f", "\u2400\u241b\u2421"),
        ("a\u202eb\u2066", "a\u27e8U+202E\u27e9b\u27e8U+2066\u27e9"),
        ("\x9b\ud800\u2028", "\u27e8U+009B\u27e9\u27e8U+D800\u27e9\u27e8U+2028\u27e9"),
        ("\u65e5\u672c \u05d0", "\u65e5\u672c \u05d0"),
    ],
)
def test_what_cannot_be_seen_is_made_visible(text: str, seen: str) -> None:
    assert visible(text) == seen


def test_long_texts_are_folded_and_pages_stay_small(tmp_path: Path) -> None:
    loud = ExchangeEntry(round=0, role="planner", messages=[("user", "<\u202e" * 250_000)], reply="<" * 1_000_000)
    big = spoken(tmp_path, exchanges=[loud] * 30)
    html = page(big, folder=tmp_path)
    assert len(html.encode()) <= PAGE_MAX
    assert "characters left out" in html
    one = page(spoken(tmp_path, exchanges=[loud]), folder=tmp_path)
    assert parse(one).all("details", class_="long")
    assert not parse(page(spoken(tmp_path), folder=tmp_path)).all("details", class_="long")


def test_an_episode_says_how_its_answers_came(tmp_path: Path) -> None:
    again = [("user", "Is it so?"), ("assistant", "Perhaps."), ("user", "Once more.")]
    asked = [
        ExchangeEntry(round=0, role="checker", messages=again[:1], reply="Perhaps."),
        ExchangeEntry(round=0, role="checker", messages=again, reply="Who knows."),
        ExchangeEntry(round=0, role="adjuster", messages=again[:1], error="cut_short"),
    ]
    usage = UsageEntry(calls=3, requests=5, repeats=1)
    problems = ["checker: no verdicts", "adjuster: cut_short: after 9 characters"]
    html = page(spoken(tmp_path, exchanges=asked, usage=usage, planner_errors=problems), folder=tmp_path)
    assert "3 calls in 5 requests, 1 question answered before, 1 answer sent back" in html
    (unusable,) = [each for each in parse(html).all("section") if each.attributes.get("id") == "unusable"]
    assert "Answers that could not be used" in unusable.text and "checker: no verdicts" in unusable.text
    assert "cut_short" not in unusable.text and "no plans" not in html
    (unanswered,) = [each for each in parse(html).all("section") if each.attributes.get("id") == "unanswered"]
    assert "adjuster: cut_short: after 9 characters" in unanswered.text and "checker" not in unanswered.text
    plain = page(spoken(tmp_path), folder=tmp_path)
    assert "1 call<" in plain and 'id="unusable"' not in plain


def test_rounds_are_counted_from_one_for_people(tmp_path: Path) -> None:
    outcome = OutcomeEntry(subtask="pick up pan", status="failure", seconds=1.0)
    told = record(success=False, outcomes=[{"robot_0": outcome}])
    facts = {"setting": "s", "task": told.task, "agent": "CC", "method": "CC", "seed": 0, "what": "it slipped"}
    blame = Blame(job=told.job, iteration=0, label="skill", round=0, **facts)
    html = page(told, folder=tmp_path, blame=blame)
    assert '<a href="#round-1">Round 1</a>: ' in html and 'id="round-1"' in html
    assert "round 1, robot_0: pick up pan: failure" in html and "ound-0" not in html and "ound 0" not in html
    (sheet,) = blame_sheets([blame], folder="DIR")
    assert sheet.rows[0]["first"].text == "seed 0, round 1"


def test_an_episode_shows_its_rounds(run: Path) -> None:
    each = next(r for r in read_records(run) if r.method == "REMAC" and r.iteration == 0)
    root = parse((run / "episodes" / page_name(each)).read_text("utf-8"))
    assert [part.text.strip() for part in root.all("p", class_="goal")] == [each.goal] and each.goal.startswith("place")
    rounds = [part for part in root.all("article", class_="round") if part.attributes["id"].startswith("round-")]
    assert [part.attributes["id"] for part in rounds] == [f"round-{number}" for number in range(1, each.rounds + 1)]
    for number, part in enumerate(rounds):
        for outcome in each.outcomes[number].values():
            assert outcome.subtask in part.text
        conditions = [c.condition for c in each.pre_checks if c.round == number]
        conditions += [c.condition for c in each.post_checks if c.round == number + 1]
        assert all(condition in part.text for condition in conditions)
    busy = sum(o.subtask != "wait" for outcomes in each.outcomes for o in outcomes.values())
    assert len(root.all("a", class_="bar")) == busy
    assert all(text in root.text for text in each.reflections)
    spans = round_spans(each)
    assert spans[-1][1] == pytest.approx(each.sim_seconds) and spans[0][0] == 0.0


def test_wrong_verdicts_stand_out(tmp_path: Path) -> None:
    html = page(hostile(), folder=tmp_path)
    assert len(parse(html).all("tr", class_="wrong")) == 1
    right = hostile().model_copy(update={"pre_checks": [hostile().pre_checks[0].model_copy(update={"truth": True})]})
    assert parse(page(right, folder=tmp_path)).all("tr", class_="wrong") == []


def test_what_a_checker_cannot_tell_is_neither_right_nor_wrong_on_a_page(tmp_path: Path) -> None:
    root = parse(page(hostile(), folder=tmp_path))
    told = [row.text for row in root.all("tr") if "cannot tell" in row.text]
    assert len(told) == 1 and "(in other words)" in told[0]
    assert "; checked by " in root.text
    assert root.all("td", class_="is-false") == []


def test_images_that_a_checker_saw(run: Path) -> None:
    root = parse((run / "episodes" / "spoken-0.html").read_text("utf-8"))
    (picture,) = root.all("img")
    assert picture.attributes["src"] == "../pictures/a1b2c3.png"
    assert "an image that is not in the folder" in root.text and "9 tokens, $0.25," in root.text


def test_what_changed_in_a_world() -> None:
    before = {"robots": {"robot_0": {"holding": None}}, "objects": {"pan": {"place": ["slot", "counter.1"]}}}
    after = {"robots": {"robot_0": {"holding": "pan"}}, "objects": {"pan": {"place": ["held", "robot_0"]}}}
    assert changes(before, after) == [
        ("robot_0 holding", "\u2013", "pan"),
        ("pan place", "slot counter.1", "held robot_0"),
    ]
    assert changes(before, before) == []


def test_the_video_is_the_folders_own(tmp_path: Path) -> None:
    (tmp_path / "videos").mkdir()
    (tmp_path / "videos" / "a.webm").write_bytes(b"film")
    outcomes = [{"robot_0": OutcomeEntry(subtask="pick up pan", status="success", seconds=8.0)}]
    for path, there in [("videos/a.webm", 1), ("videos/../x.webm", 0), ("videos/b.webm", 0), ("/etc/passwd", 0)]:
        one = record(video=VideoEntry(path=path, rounds=[0.0]), outcomes=outcomes)
        assert len(parse(page(one, folder=tmp_path)).all("video")) == there, path
    (gantt,) = parse(page(one, folder=tmp_path)).all("svg", class_="gantt")
    assert (gantt.attributes["data-starts"], gantt.attributes["data-video"]) == ("0.0 8.0", "0.0")


def _results(money: float) -> Sheet:
    row = {"task": Cell(text="T"), "agent": Cell(text="A"), "tsr": Cell(text="50%", value=0.5, low=0.2, high=0.8)}
    row |= {"seconds_all": Cell(text="9", value=9.0), "money": Cell(text="m", value=money)}
    return Sheet(key="results", title="t", columns=(Column(key="task", title="Task"),), rows=(row,))


def test_success_is_plotted_against_money_where_there_was_any() -> None:
    paid, free = scatter(_results(3.0)), scatter(_results(0.0))
    assert paid is not None and "dollars" in paid.axis and paid.note == ""
    assert free is not None and "seconds" in free.axis and "No entry spent money" in free.note
    (dot,) = paid.dots
    assert dot.high < dot.y < dot.low and dot.x == paid.x_ticks[-1][0]


def test_a_table_as_a_picture_shows_every_number() -> None:
    sheet = _results(3.0)
    columns = tuple(Column(key=key, title=key) for key in sheet.rows[0])
    drawing = lay_out(Sheet(key="k", title="Title", columns=columns, rows=sheet.rows))
    shown = [text for key, cell in sheet.rows[0].items() for text in (key, cell.text)]
    assert [word.text for word in drawing.words] == ["Title", *shown]
    picture = paint(drawing)
    assert picture.min() < 80 and picture.max() == 255


def test_the_command_writes_pages_unless_told_not_to(tmp_path: Path) -> None:
    Store(tmp_path).append([record()])
    assert CliRunner().invoke(app, ["bench", "report", str(tmp_path), "--no-pages"]).exit_code == 0
    assert not (tmp_path / "leaderboard.html").exists()
    result = CliRunner().invoke(app, ["bench", "report", str(tmp_path)])
    assert result.exit_code == 0 and "leaderboard.html" in result.stderr
    (tmp_path / "episodes" / "old.html").write_text("old", "utf-8")
    assert CliRunner().invoke(app, ["bench", "report", str(tmp_path)]).exit_code == 0
    assert {path.name for path in (tmp_path / "episodes").iterdir()} == {"j0-0.html"}


def made(html: str) -> dict[str, str]:
    """What an episode's page says of how it was made."""
    (facts,) = parse(html).all("dl", class_="made")
    return {each.all("dt")[0].text: " ".join(each.all("dd")[0].text.split()) for each in facts.all("div")}


def test_an_episode_page_gives_the_command_that_plays_it_again(run: Path) -> None:
    each = next(r for r in read_records(run) if r.method == "REMAC" and r.iteration == 1)
    facts = made((run / "episodes" / page_name(each)).read_text("utf-8"))
    assert facts["Date"] == each.started and each.started is not None and each.started.endswith("+00:00")
    assert facts["Machine"] == each.machine and "core" in str(each.machine)
    assert each.versions["code"] in facts["Code"] and each.job in facts["Job"]
    command = shlex.split(facts["Play it again"].partition(" (with")[0])
    assert command[0] == "remac"
    result = CliRunner().invoke(app, command[1:])
    assert result.exit_code == 0 and "as recorded: success" in result.stdout
    assert sum(line.startswith("1. robot_") for line in result.stdout.splitlines()) == each.robots
    assert "not recorded" in made(page(record(), folder=run))["Date"]


@pytest.mark.long
def test_a_replay_can_be_filmed(run: Path, tmp_path: Path) -> None:
    each = next(r for r in read_records(run) if r.method == "CC")
    film = tmp_path / "film.webm"
    result = CliRunner().invoke(app, ["bench", "replay", str(run), each.job, "--video", str(film)])
    assert result.exit_code == 0 and film.stat().st_size > 10_000
    assert "video:" in result.stdout and "as recorded: success" in result.stdout


def test_a_replay_that_differs_says_so(run: Path, tmp_path: Path) -> None:
    each = next(r for r in read_records(run) if r.method == "CC")
    forged = each.model_copy(update={"sim_seconds": each.sim_seconds + 1})
    Store(tmp_path).append([forged])
    result = CliRunner().invoke(app, ["bench", "replay", str(tmp_path), each.job])
    assert result.exit_code == 1 and "sim_seconds" in result.stdout and "not as recorded" in result.stdout
    for arguments, told in ((["nobody"], f"valid: {each.job}"), ([each.job, "--iteration", "7"], "valid: 0")):
        refused = CliRunner().invoke(app, ["bench", "replay", str(tmp_path), *arguments])
        assert refused.exit_code == 2 and told in refused.stderr


def test_failures_are_linked_one_to_the_next(tmp_path: Path) -> None:
    won = {0: True, 1: False, 2: True, 3: False, 4: False}
    Store(tmp_path).append([record(job=f"j{seed}", seed=seed, success=won[seed]) for seed in won])
    write_pages(tmp_path)
    links = {}
    for seed in won:
        root = parse((tmp_path / "episodes" / f"j{seed}-0.html").read_text("utf-8"))
        links[seed] = [each.attributes["href"] for each in root.all("a") if "failure" in each.text]
    assert links == {
        0: ["j1-0.html"],
        1: ["j3-0.html"],
        2: ["j1-0.html", "j3-0.html"],
        3: ["j1-0.html", "j4-0.html"],
        4: ["j3-0.html"],
    }


def test_several_folders_make_one_report(tmp_path: Path) -> None:
    first, second, out = (tmp_path / name for name in ("first", "second", "all runs"))
    for folder, agent in ((first, "CC"), (second, "REMAC")):
        folder.mkdir()
        Store(folder).append([record(job=agent, agent=agent, method=agent), record(job="both")])
    Store(second).append([spoken(second, video=VideoEntry(path="videos/a.webm"))])
    (second / "videos").mkdir()
    (second / "videos" / "a.webm").write_bytes(b"film")
    refused = CliRunner().invoke(app, ["bench", "report", str(first), str(second)])
    assert refused.exit_code == 2 and "--out is missing" in refused.stderr
    result = CliRunner().invoke(app, ["bench", "report", str(first), str(second), "--out", str(out), "--all"])
    assert result.exit_code == 0 and "REMAC" in result.stdout
    html = leaderboard(out)
    assert "4 scored episodes of 4 played" in html and f"{first} {second} --all" in html
    assert {path.name for path in (out / "episodes").iterdir()} == {
        "CC-0.html", "REMAC-0.html", "both-0.html", "spoken-0.html",
    }  # fmt: skip
    pages = [out / "leaderboard.html", *(out / "episodes").iterdir()]
    assert {path.name: dead_links(out, path) for path in pages if dead_links(out, path)} == {}
    assert "../videos/a.webm" in (out / "episodes" / "spoken-0.html").read_text("utf-8")
    assert not (first / "leaderboard.html").exists() and not (second / "leaderboard.html").exists()


def test_a_folder_that_cannot_be_written_is_said_in_one_line(tmp_path: Path) -> None:
    Store(tmp_path).append([record()])
    (tmp_path / "episodes").write_text("in the way", "utf-8")
    result = CliRunner().invoke(app, ["bench", "report", str(tmp_path)])
    assert result.exit_code == 1 and "--no-pages" in result.stderr and result.stderr.count("\n") == 1


def _names(root: Element) -> list[str]:
    return [each.tag for each in root.walk()]


def test_headings_sort_by_button(run: Path) -> None:
    root = parse(leaderboard(run))
    heads = root.all("th")
    assert heads and all(_names(head) == ["button"] for head in heads)


def test_a_page_says_what_a_generated_task_was_made_from(tmp_path: Path) -> None:
    kitchen = {"grade": 3, "quirks": 2, "knowledge": "seen"}
    one = record(task="Generated", template="some plates", known_rounds=17, options={"kitchen": kitchen})
    told = "Grade 3, template “some plates”, 2 quirks, what is behind doors has to be found, a plan of 17 rounds is"
    assert made_from(one) == f"{told} known" and told in parse(page(one, folder=tmp_path)).text
    plain = record(task="Generated", options={"kitchen": {"grade": 1, "quirks": 1}})
    assert made_from(plain) == "Grade 1, 1 quirk, everything is known" and made_from(record()) == ""


@pytest.mark.parametrize(
    ("quirks", "said"), [(0, "1 quirk (takes two robots)"), (2, "3 quirks (one of them takes two robots)")]
)
def test_the_page_of_a_task_for_a_team_counts_the_quirk_that_it_is_about(quirks: int, said: str) -> None:
    kitchen = {"grade": 2, "quirks": quirks, "knowledge": "full"}
    assert said in made_from(record(task="Generated", template="dishwasher for two", options={"kitchen": kitchen}))
