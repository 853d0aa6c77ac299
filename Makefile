# make demo       install, run the four tasks with four methods in physics, print the table, write records and videos
# make test       install, lint, type-check and run the fast tests
# make test-all   the same with the long tests, and robosuite's
# make rl         install torch and libraries for learners apart, and run the tests and examples of learning there;
#                 make rl-install without the tests
# make docs       install what builds the site apart, and build it into build/site
# make learned    train the weights that come with the package, from nothing, and measure them
# make vision     the same for the checker that sees
# make ray        install RLlib and Tianshou apart, and run the tests of their examples there
# make pddl       install a temporal and a classical planner apart, and run the tests that let them play
# make inspect    install Inspect AI apart, and run the test of its example there
# make loaders    install lerobot and robomimic apart, and read with them what `remac learn record` writes
# make wheel      build wheel and source archive into dist/, check them and try each in an empty environment
# make versions   the fast tests without physics on every supported Python, and with the oldest dependencies
# make robosuite  install robosuite apart, run the tests of our kitchens in it and print how fast they are
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
ROBOSUITE := .venv-robosuite
RL := .venv-rl
DOCS := .venv-docs
WHEEL := .venv-wheel
INSPECT := .venv-inspect
RAY := .venv-ray
PDDL := .venv-pddl
LOADERS := .venv-loaders
REPOSITORY ?=

.PHONY: demo test test-all rl learned vision loaders docs inspect pddl ray wheel versions robosuite robosuite-test tables tables-check lint
.PHONY: install rl-install clean

$(VENV)/.installed: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/.installed-dev: $(VENV)/.installed
	$(BIN)/pip install --quiet --disable-pip-version-check --editable ".[dev]"
	touch $@

install: $(VENV)/.installed

demo: $(VENV)/.installed
	$(BIN)/remac demo

lint: $(VENV)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/mypy

test: lint tables-check
	$(BIN)/pytest -n 2 -m "not long"

# Every table of README and docs from the command that stands beside it; tables-check looks at those that take seconds.
tables: $(VENV)/.installed-dev
	$(BIN)/python docs/make_tables.py

tables-check: $(VENV)/.installed-dev
	$(BIN)/python docs/make_tables.py --check

test-all: lint robosuite-test
	$(BIN)/pytest -n 2

# Without robosuite's own pins, which force an old NumPy and a compiler: docs/robosuite.md.
$(ROBOSUITE)/.installed: pyproject.toml
	$(PYTHON) -m venv $(ROBOSUITE)
	$(ROBOSUITE)/bin/pip install --quiet --disable-pip-version-check --editable ".[for-robosuite]" pytest pytest-xdist hypothesis
	$(ROBOSUITE)/bin/pip install --quiet --disable-pip-version-check --no-deps robosuite==1.5.2
	touch $@

robosuite-test: $(ROBOSUITE)/.installed
	$(ROBOSUITE)/bin/python -m pytest -n 2 tests/integrations

robosuite: robosuite-test
	$(ROBOSUITE)/bin/python benchmarks/speed.py --only robosuite

# The extra first takes the torch that is there: where an index has builds for the CPU alone, they are small and enough.
$(RL)/.installed: pyproject.toml
	$(PYTHON) -m venv $(RL)
	$(RL)/bin/pip install --quiet --disable-pip-version-check torch==2.13.0
	$(RL)/bin/pip install --quiet --disable-pip-version-check --editable ".[rl]" pytest pytest-xdist hypothesis
	touch $@

rl-install: $(RL)/.installed

rl: $(RL)/.installed
	$(RL)/bin/python -m pytest -n 2 tests/integrations/test_learning.py

$(DOCS)/.installed: pyproject.toml
	$(PYTHON) -m venv $(DOCS)
	$(DOCS)/bin/pip install --quiet --disable-pip-version-check --editable ".[docs]"
	touch $@

docs: $(DOCS)/.installed
	$(DOCS)/bin/python docs/make_site.py

# The skills that are shipped, from nothing: demonstrations, networks, and how often they succeed. Some 81 minutes of a core, 52 of two.
# What is rare among demonstrations is recorded more often: docs/learning.md. Smaller: make learned EPISODES=8 RARE=2 TRIALS=2
# EPOCHS=5 DEMOS=build/demos SHIPPED=build/weights
LEARNED := OpenDoor,CloseDoor,TurnOn,TurnOff
HANDLED := PickUp,PlaceTo,NavigateTo
SHIPPED := remac_env/backends/physics/controllers/learned/shipped
DEMOS := demos
EPISODES := 160
RARE := 30
EPOCHS := 60
TRIALS := 300
$(RL)/.installed-learn: $(RL)/.installed
	$(RL)/bin/pip install --quiet --disable-pip-version-check --editable ".[learn]"
	touch $@

RECORD := $(RL)/bin/remac learn record --out $(DEMOS) --processes 2
MORE := $(RECORD) --episodes $(RARE)
FOOD := $(RECORD) --skills PickUp --case "food on surface"
PUT := $(RECORD) --skills PlaceTo
learned: $(RL)/.installed-learn
	$(RECORD) --skills $(LEARNED) --episodes $(EPISODES)
	$(MORE) --first-seed 3000 --skills TurnOn,TurnOff --target stove --style scandinavian
	$(MORE) --first-seed 3000 --skills OpenDoor --target microwave --style industrial
	$(MORE) --first-seed 4000 --skills OpenDoor --target cabinet --layout one_wall_small
	$(FOOD) --first-seed 10000 --target vegetable --episodes $$(($(EPISODES) * 7 / 4))
	$(FOOD) --first-seed 12000 --target meat --episodes $(EPISODES)
	$(FOOD) --first-seed 13000 --target fish --episodes $(EPISODES)
	$(FOOD) --first-seed 20000 --episodes $$(($(EPISODES) * 9 / 4))
	$(RECORD) --skills PickUp --first-seed 25000 --case "vessel on surface" --episodes $$(($(EPISODES) / 2))
	$(PUT) --first-seed 10000 --case "food in vessel on surface" --episodes $$(($(EPISODES) * 5 / 4))
	$(PUT) --first-seed 12000 --case "food on surface" --episodes $$(($(EPISODES) / 4))
	$(PUT) --first-seed 14000 --case "food in vessel on cavity" --episodes $$(($(EPISODES) * 3 / 2))
	$(PUT) --first-seed 15000 --case "vessel on burner" --episodes $$(($(EPISODES) / 4))
	$(PUT) --first-seed 16000 --case "vessel on basin" --episodes $$(($(EPISODES) * 7 / 4))
	$(PUT) --first-seed 17000 --case "food in vessel on burner" --episodes $$(($(EPISODES) / 4))
	$(PUT) --first-seed 18000 --case "food in vessel on basin" --episodes $$(($(EPISODES) / 2))
	$(RECORD) --first-seed 10000 --skills NavigateTo --episodes $$(($(EPISODES) * 5 / 2))
	$(RECORD) --first-seed 28000 --skills NavigateTo --case carrying --episodes $$(($(EPISODES) / 2))
	$(RL)/bin/remac learn train --skills $(LEARNED) --demos $(DEMOS) --weights $(SHIPPED) --epochs $(EPOCHS)
	$(RL)/bin/remac learn train --skills PickUp --hand --demos $(DEMOS) --weights $(SHIPPED) --epochs $$(($(EPOCHS) / 4 + 1))
	$(RL)/bin/remac learn train --skills PlaceTo --hand --demos $(DEMOS) --weights $(SHIPPED) --epochs $$(($(EPOCHS) / 2))
	$(RL)/bin/remac learn train --skills NavigateTo --width 256 --demos $(DEMOS) --weights $(SHIPPED) --epochs $$(($(EPOCHS) / 3))
	$(RL)/bin/remac learn evaluate --skills $(LEARNED),$(HANDLED) --weights $(SHIPPED) --trials $(TRIALS) --note --processes 2

# Without what lerobot needs for robots and policies, and with the build of torch for the CPU; 1.8 GB.
$(LOADERS)/.installed: pyproject.toml
	$(PYTHON) -m venv $(LOADERS)
	$(LOADERS)/bin/pip install --quiet --disable-pip-version-check torch==2.13.0
	$(LOADERS)/bin/pip install --quiet --disable-pip-version-check --editable ".[dev,learn,lerobot]" pandas "datasets>=4,<5" \
		"av>=15,<16" einops draccus==0.10.0 deepdiff jsonlines matplotlib psutil safetensors six termcolor tqdm
	$(LOADERS)/bin/pip install --quiet --disable-pip-version-check --no-deps lerobot==0.4.4 torchvision==0.28.0 accelerate==1.15.0 \
		robomimic==0.3.0
	touch $@

loaders: $(LOADERS)/.installed
	$(LOADERS)/bin/python -m pytest tests/bench/test_loaders.py tests/bench/test_lerobot.py tests/bench/test_learn.py

# The checker that sees, from nothing: pictures of kitchens, a network, and how often it is right.
PICTURES := pictures
EYES := remac_agents/vision/shipped/vision.npz
vision: $(RL)/.installed-learn
	$(RL)/bin/remac learn record-checker --backend symbolic --first-seed 1000 --episodes 128 --out $(PICTURES)/train
	$(RL)/bin/remac learn record-checker --first-seed 110000 --episodes 4 --out $(PICTURES)/train
	$(RL)/bin/remac learn record-checker --held-out --backend symbolic --first-seed 122000 --episodes 24 --out $(PICTURES)/calibrate
	$(RL)/bin/remac learn record-checker --held-out --first-seed 120000 --episodes 2 --out $(PICTURES)/calibrate
	$(RL)/bin/remac learn record-checker --held-out --first-seed 130000 --episodes 4 --out $(PICTURES)/test
	$(RL)/bin/remac learn record-checker --held-out --backend symbolic --first-seed 132000 --episodes 8 --out $(PICTURES)/test
	$(RL)/bin/remac learn train-checker --pictures $(PICTURES) --weights $(EYES)
	$(RL)/bin/remac learn evaluate-checker --pictures $(PICTURES)/test

# REPOSITORY is the address that README's links and the project's URLs shall lead to: docs/package_readme.py.
$(WHEEL)/.installed:
	$(PYTHON) -m venv $(WHEEL)
	$(WHEEL)/bin/pip install --quiet --disable-pip-version-check build twine
	touch $@

wheel: $(WHEEL)/.installed
	REMAC_REPOSITORY=$(REPOSITORY) $(WHEEL)/bin/python .ci/package.py

versions:
	$(PYTHON) .ci/versions.py

# RLlib and Tianshou, 2.3 GB with torch: examples/rl.
$(RAY)/.installed: pyproject.toml
	$(PYTHON) -m venv $(RAY)
	$(RAY)/bin/pip install --quiet --disable-pip-version-check torch==2.13.0
	$(RAY)/bin/pip install --quiet --disable-pip-version-check --editable ".[rllib]" pytest hypothesis
	touch $@

ray: $(RAY)/.installed
	$(RAY)/bin/python -m pytest tests/integrations/test_other_learners.py

# Programs that plan from PDDL: docs/planners.md. pyperplan is GPL, and is only started.
$(PDDL)/.installed: pyproject.toml
	$(PYTHON) -m venv $(PDDL)
	$(PDDL)/bin/pip install --quiet --disable-pip-version-check --editable ".[pddl]" pyperplan==2.1 pytest hypothesis
	touch $@

pddl: $(PDDL)/.installed
	$(PDDL)/bin/python -m pytest tests/agents/planners/test_agent_pddl.py tests/symbolic/test_symbolic_pddl.py

# A model's tool calls in Inspect AI, with its own mock model: examples/inspect.
$(INSPECT)/.installed: pyproject.toml
	$(PYTHON) -m venv $(INSPECT)
	$(INSPECT)/bin/pip install --quiet --disable-pip-version-check --editable ".[inspect]" pytest hypothesis
	touch $@

inspect: $(INSPECT)/.installed
	$(INSPECT)/bin/python -m pytest tests/integrations/test_inspect.py

clean:
	rm -rf $(VENV) $(ROBOSUITE) $(RL) $(DOCS) $(WHEEL) $(INSPECT) $(RAY) $(LOADERS) $(PDDL) dist build .cache demo_output .pytest_cache .mypy_cache .ruff_cache
