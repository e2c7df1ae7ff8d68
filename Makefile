# Every target can be the first thing that is run in a fresh clone: it installs what it needs.
.DEFAULT_GOAL := help
.PHONY: help demo test vectors bench operators tools campaigns formal machine-proofs doc lint clean

# The project's own tools go before the system's.
ENVIRONMENT := . tools/environment;
CAMPAIGNS := cargo run --release --locked --quiet --package campaigns --
STEPWELL := cargo run --release --locked --quiet --package stepwell --

help: ## this list
	@sed -n 's/^\([a-z-]*\):[a-z ]*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 16

demo: tools ## render a scene, run its Verilog beside the golden model, compare every cycle
	@$(ENVIRONMENT) tools/demo

test: lint ## everything CI checks: format, lints, documentation, all tests
	$(ENVIRONMENT) cargo test --workspace --locked --doc
	$(ENVIRONMENT) cargo test --workspace --locked --lib --bins --tests --examples

vectors: tools ## rewrite the committed vectors under vectors/; git diff shows what changed
	rm -f vectors/*.hex vectors/fp24/*.txt
	$(ENVIRONMENT) $(STEPWELL) vectors -o vectors
	$(ENVIRONMENT) $(STEPWELL) corpus -o vectors/fp24

bench: tools ## speed of the golden model and of the harness, as ratios within one run
	$(ENVIRONMENT) cargo bench --workspace --locked

operators: tools ## measure area and speed of the operators anew, into docs/operators.md
	$(ENVIRONMENT) $(STEPWELL) area --table docs/operators.md

tools: ## install the compiler, simulators and synthesis tools where they are missing
	@tools/install

campaigns: tools ## hours: arithmetic, operators and walks against their judges, into docs/campaigns.md
	$(ENVIRONMENT) for campaign in softfloat routes hardware small-worlds walks; do \
	    $(CAMPAIGNS) $$campaign --tier substantial --record docs/campaigns.md || exit; done

formal: tools ## hardware operators proven equal to plain specifications, into docs/campaigns.md
	$(ENVIRONMENT) $(CAMPAIGNS) formal --tier substantial --record docs/campaigns.md

machine-proofs: tools ## FIFO, read port, height cache and the paper's machine proven, each with faults that are found
	formal/check

lint: tools ## formatting, clippy and documentation, every warning an error; the shell scripts
	tools/install_test
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --locked -- -D warnings
	RUSTDOCFLAGS='-D warnings' cargo doc --workspace --no-deps --locked --quiet

doc: tools ## the libraries' documentation, in target/doc
	cargo doc --workspace --no-deps --locked

clean: ## remove everything built, downloaded or written here
	cargo clean
	rm -rf out .venv
