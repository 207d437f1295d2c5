# Two commands do all the set-up: `make demo` and `make test`. Both create and use .venv/.
# Needs Python 3.11 or 3.12; name another one with `make PYTHON=python3.12 demo`.
PYTHON ?= $(shell for p in python3.12 python3.11 python3 python; do \
	$$p -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 13))' 2>/dev/null \
	&& echo $$p && break; done)
BIN := .venv/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check

# Hundreds of processes would each compile the package's sources where no bytecode may be kept.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo demo-diagnosis demo-law laws test nightly check fast fuzz attack mutation types lint layers loop bench figures fidelity real scorecard diagnosis-scorecard picture docs clean

demo: .venv/.run
	$(BIN)/ves-twin run beam_horizontal_truth --out runs/demo

# An effect chosen by the clock is hidden in a run of VES II and found from the recordings alone.
HIDDEN := runs/demo-diagnosis
demo-diagnosis: .venv/.run
	rm -rf $(HIDDEN) $(HIDDEN).key
	$(BIN)/ves-twin blind make --machine ves2_fast --cases 1 --none 0 --outside 0 --pair 0 --out $(HIDDEN)
	$(BIN)/ves-twin diagnose $(HIDDEN)/case-0001/recording.parquet --plant ves2_pressure_fast \
		--held-out $(HIDDEN)/case-0001/held_out.parquet \
		--out $(HIDDEN)/diagnosis
	$(BIN)/ves-twin blind reveal --out $(HIDDEN)

# A law that no library has is drawn by the clock, hidden in a pendulum and found; KIND=drag: drag.
KIND ?= drawn
demo-law: .venv/.run
	$(BIN)/python benchmarks/demo_law.py --kind $(KIND) --out runs/demo-law

# The inner loop compiles while types are checked: each takes one core, and both workers would compile.
test: .venv/.dev
	$(MAKE) --no-print-directory --jobs=2 lint layers types loop
	$(BIN)/python -m pytest -n 2 --dist worksteal --durations=25 --costs=runs/test-costs.csv

# Statistical suites at full size as well; ends with one table of them.
nightly: .venv/.dev lint layers types attack
	$(BIN)/python -m pytest -n 2 --dist worksteal --nightly --mutations 10000 \
		--costs=runs/nightly-costs.csv
	$(BIN)/python benchmarks/suites.py --size full --folder runs/blind

check: .venv/.dev lint layers types fast

fast: .venv/.dev
	$(BIN)/python -m pytest -n 2 --dist worksteal -m "not slow"

fuzz: .venv/.dev
	$(BIN)/python -m pytest -n 2 tests/fuzz --mutations 10000

# A standing attack: N inputs on every reader, KILLS of runs and as many on other commands that
# write, with two at a time in one folder; seeds are drawn and printed.
N ?= 20000
KILLS ?= 200
attack: .venv/.dev
	$(BIN)/python tests/attack/attack_inputs.py --inputs $(N) --out runs/attack.jsonl
	$(BIN)/python tests/attack/attack_commands.py --kills $(KILLS) --others $(KILLS)

# Mutants of the kernels and of the diagnosis core; hours, and goes on where it stopped.
mutation: .venv/.dev
	$(BIN)/python benchmarks/mutation.py runs/mutation.jsonl

# Compiles the inner loops, which takes most of a minute where no cache has them.
loop: .venv/.run
	$(BIN)/ves-twin run beam_horizontal_truth --no-rrd --set run.duration=0.1 --out runs/loop
	rm -rf runs/loop-pendulum runs/loop-pendulum.key
	$(BIN)/ves-twin blind make --machine pendulum --cases 1 --none 0 --outside 0 --pair 0 --out runs/loop-pendulum

lint: .venv/.dev
	$(BIN)/ruff check . && $(BIN)/ruff format --check .

types: .venv/.dev
	$(BIN)/mypy

layers: .venv/.dev
	$(BIN)/lint-imports

bench: .venv/.dev
	$(BIN)/python benchmarks/loop_speed.py
	$(BIN)/python benchmarks/memory.py
	$(BIN)/python benchmarks/measured.py
	$(BIN)/python benchmarks/environments.py
	$(BIN)/python benchmarks/many_environments.py
	$(BIN)/python benchmarks/diagnosis_time.py
	$(BIN)/python benchmarks/diagnosis_runs.py

# into site/; warnings are errors. It runs the notebooks (RUN_NOTEBOOKS=no: pages without outputs). The
# other variable silences an advertisement of the theme's.
docs: .venv/.dev
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build

picture: .venv/.dev
	$(BIN)/python benchmarks/picture.py docs/run.png

scorecard: .venv/.run
	$(BIN)/ves-twin reproduce --out runs/scorecard
	cp runs/scorecard/thesis-scorecard.md docs/thesis-scorecard.md

diagnosis-scorecard: .venv/.run
	$(BIN)/python benchmarks/suites.py --size full --folder runs/blind --page docs/diagnosis-scorecard.md

figures: .venv/.dev
	$(BIN)/python -m pytest -n 0 --nightly --figures docs/figures.md \
		tests/mechanics/kinematics/test_stewart.py tests/plant tests/simulator

# laws that no library has, hidden in the pendulum: counts for docs/laws.md
laws: .venv/.dev
	$(BIN)/python benchmarks/laws.py --out runs/laws

# measured machines; the data are looked for in ../shared/data or VES_TWIN_DATA
real: .venv/.dev
	$(BIN)/python benchmarks/real_machines.py

fidelity: .venv/.dev
	$(BIN)/python benchmarks/fidelity.py docs/fidelity.md

.venv/.run: pyproject.toml constraints.txt
	@test -n "$(PYTHON)" || { echo "ves_twin needs Python 3.11 or 3.12; none was found (make PYTHON=... demo)"; exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(PIP) --constraint constraints.txt --editable .
	@touch $@

.venv/.dev: .venv/.run
	$(PIP) --constraint constraints.txt --editable ".[dev]"
	@touch $@

clean:
	rm -rf .venv build dist runs site
