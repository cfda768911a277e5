# The entries a reader needs. `make help` lists them.

ISOSTUDY = cargo run --release --locked --quiet --package isostudy --bin isostudy --
BUNNY ?=
THREE ?=
# Of the random tests in `make test-long`, another each time; those of `make test` have a fixed one (`.cargo/config.toml`).
ifndef SEED
SEED := $(shell od -An -N4 -tu4 /dev/urandom | tr -d ' ')
endif

.PHONY: help study test test-long attacks quick terrain families bench bench-sweep barometer barometer-quick figures check bunny three viewer-library cgal wheel clean

help: ## list these entries
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):[^#]*## /\1\t/' | expand -t 11

study: bunny viewer-library ## regenerate every mesh, animation, table and figure of the paper into results/paper/
	$(ISOSTUDY) study configs/paper.toml

test: bunny viewer-library ## run every test; those in a browser need Node and chromium and say so where there is none
	@failed=0; \
	cargo test --release --locked --workspace --no-fail-fast || failed=1; \
	scripts/test-browser.sh || failed=1; \
	exit $$failed

test-long: bunny ## run the tests that take minutes: 74,640 volumes against the manifold guarantee, and more; SEED=n repeats the draws of a run
	@echo "random tests draw with the seed $(SEED); \`make test-long SEED=$(SEED)\` repeats them"
	@PROPTEST_RNG_SEED=$(SEED) cargo test --release --locked --workspace --no-fail-fast -- --include-ignored || \
	{ echo "failed with the seed $(SEED): repeat it by \`make test-long SEED=$(SEED)\`" >&2; exit 1; }
	cargo build --release --locked --package isostudy
	scripts/test-cluster.sh target/release/isostudy $(SEED)
	cargo check --manifest-path examples/engines/Cargo.toml --target-dir target/engines --workspace

attacks: bunny ## attack the command: bad programs, 20,000 damaged files, a server and a study under kills, full disks and removed folders
	cargo build --release --locked -p isostudy
	scripts/attack-programs.py target/release/isostudy
	scripts/attack-readers.py target/release/isostudy 20000 $(SEED)
	scripts/attack-server.py target/release/isostudy
	scripts/attack-study.py target/release/isostudy

quick: bunny viewer-library ## the same study made small, into results/quick/
	$(ISOSTUDY) study configs/quick.toml

terrain: cache/methods/installed viewer-library ## methods for terrain in games, with cells and with triangles alike, into results/terrain/
	PATH="$(CURDIR)/cache/methods/bin:$$PATH" $(ISOSTUDY) study configs/terrain.toml --allow-programs

families: cache/methods/installed viewer-library ## one method of every family on four objects, into results/all/
	python3 scripts/all-grids.py cache/grids
	PATH="$(CURDIR)/cache/methods/bin:$$PATH" $(ISOSTUDY) study configs/all.toml --allow-programs

cache/methods/installed: scripts/methods/requirements.txt
	python3 -m venv cache/methods
	if cache/methods/bin/pip install --quiet --requirement scripts/methods/requirements.txt; then touch $@; \
	else echo "VTK could not be installed: its methods are left out" >&2; fi

BAROMETER = cargo build --release --locked --package isostudy && target/release/isostudy barometer run configs/barometer --allow-programs --date $(shell date +%F)

barometer: bunny cache/engines/installed target/peers/release/peers-worker ## judge and time 40 extractors on 60 workloads, into results/barometer/; a run that was killed goes on
	-scripts/fetch-samples.sh >/dev/null
	$(BAROMETER) -o results/barometer
	-cache/engines/bin/python scripts/barometer/confirm.py results/barometer >results/barometer/confirm.log
	target/release/isostudy barometer report results/barometer

barometer-quick: bunny cache/engines/installed target/peers/release/peers-worker ## the same of 14 extractors on 23 workloads, into results/barometer-quick/
	$(BAROMETER) --quick -o results/barometer-quick
	-cache/engines/bin/python scripts/barometer/confirm.py results/barometer-quick >results/barometer-quick/confirm.log
	target/release/isostudy barometer report results/barometer-quick

cache/engines/installed: scripts/methods/requirements-barometer.txt scripts/methods/requirements.txt
	python3 -m venv cache/engines
	cache/engines/bin/pip install --quiet scipy
	@# One by one: an engine that cannot be had takes no other one with it.
	@grep -hE '^[A-Za-z]' scripts/methods/requirements.txt scripts/methods/requirements-barometer.txt | while read -r engine; do \
	cache/engines/bin/pip install --quiet "$$engine" || echo "$$engine could not be installed: the barometer goes on without it" >&2; done
	touch $@

target/peers/release/peers-worker: scripts/peers/Cargo.toml $(wildcard scripts/peers/src/*.rs)
	-cargo build --release --quiet --manifest-path scripts/peers/Cargo.toml --target-dir target/peers

cgal: cache/methods/cgal-surface-mesher ## build CGAL's surface mesher, a program of its own (Debian: apt install libcgal-dev)

cache/methods/cgal-surface-mesher: scripts/methods/cgal_surface_mesher.cpp
	@mkdir -p cache/methods
	@if $(CXX) -std=c++17 -O2 -DNDEBUG -o $@ $< -lmpfr -lgmp; then :; \
	else echo "CGAL's surface mesher was not built: it needs a C++17 compiler and CGAL 5 (Debian: apt install libcgal-dev)" >&2; exit 1; fi

bench: bunny ## time every configuration 100 times, as the paper does, and renew the tables
	$(ISOSTUDY) bench configs/paper.toml
	$(ISOSTUDY) study configs/paper.toml

bench-sweep: bunny ## time resolutions from 16 to 256 cells per axis on 1 and 2 threads, into results/paper/bench/sweep/
	$(ISOSTUDY) bench sweep configs/paper.toml

figures: bunny ## draw tables, figures and index.html again from the results that are there
	$(ISOSTUDY) report configs/paper.toml

check: ## formatting, lints, licences, the English of README and docs, and that nothing is built twice
	scripts/check-words.py
	scripts/published_links.py --test
	scripts/check-one-build.py
	cargo fmt --all --check
	scripts/draw-house.py --check
	cargo clippy --release --locked --workspace --all-targets -- -D warnings
	@if command -v cargo-deny >/dev/null; then cargo deny --locked check bans licenses sources; else echo "CARGO-DENY IS NOT INSTALLED: licences and bans were not checked" >&2; fi

wheel: ## build the Python wheel into target/wheels/, and run its tests and its notebook in a fresh environment
	scripts/test-wheel.sh

bunny: ## fetch and verify the Stanford bunny into cache/ (BUNNY=path takes a file of yours)
	@scripts/fetch-bunny.sh $(BUNNY) >/dev/null

three: ## fetch and verify three.js into cache/, for the viewer of meshes (THREE=path takes a package of yours)
	@scripts/fetch-three.sh $(THREE) >/dev/null

# A study goes on without it: its pages then say what is missing.
viewer-library:
	@scripts/fetch-three.sh $(THREE) >/dev/null || true

clean: ## remove what was built and made; the bunny and three.js stay
	cargo clean
	find results -mindepth 1 -maxdepth 1 ! -name README.md ! -name published -exec rm -r {} +
