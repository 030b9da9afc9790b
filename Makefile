# The static library, its package, and both for other machines.
#
#   make                     the static library
#   make install             library, headers, model, pkg-config and CMake files; PREFIX=, DESTDIR=
#   make dist                the same as target/posewise-VERSION-TARGET.tar.gz
#   make size                bytes of code that a program gets, without the model
#   make sizes CLIP=x.y4m    the same, model and memory, with and without what WITHOUT can leave out
#   make replay CLIP=x.y4m   one line with a hash of every answer to the clip; FRAMES= limits it
#
# TARGET=… makes each for another machine. Rust must know that machine: after `rustup target add
# TARGET`; or `rustup component add rust-src`, or Debian's packages rustc-web, cargo-web and
# rust-web-src, from which its core is then built.
# TARGET_DIR is cargo's build folder. MODEL=none builds no model in. WITHOUT="…" leaves out what a
# small board can do without: any of refiners, verifier, adaptation, keyframes; see docs/memory.md.
TARGET_DIR ?= $(or $(CARGO_TARGET_DIR),target)
PREFIX ?= /usr/local
CARGO ?= cargo
CLIP ?= tests/data/demo.y4m
FRAMES ?= 100
override ROOT := $(abspath $(dir $(lastword $(MAKEFILE_LIST))))
override VERSION := $(shell sed -n '/^\[workspace.package\]/,/^$$/s/^version = "\(.*\)"/\1/p' $(ROOT)/Cargo.toml)

# --- How to build for a machine: sets CARGO_RUSTC, LIB.
ifdef TARGET
override LIB := $(TARGET_DIR)/$(TARGET)/dist/libposewise.a
override LIBDIR_OF = $(shell $(1) --print sysroot)/lib/rustlib/$(TARGET)/lib
override SOURCE_OF = $(shell $(1) --print sysroot)/lib/rustlib/src/rust/library/core/src/lib.rs
ifneq ($(wildcard $(call LIBDIR_OF,rustc)/libcore-*.rlib),)
override CARGO_RUSTC := $(CARGO) rustc --target $(TARGET)
else ifneq ($(wildcard $(call SOURCE_OF,rustc)),)
override CARGO_RUSTC := RUSTC_BOOTSTRAP=1 $(CARGO) rustc -Zbuild-std=core --target $(TARGET)
else ifneq ($(wildcard $(call SOURCE_OF,/usr/bin/rustc)),)
# Debian's compiler, and its cargo, because each cargo can build only the core of its own version.
override CARGO_RUSTC := RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 /usr/bin/cargo rustc -Zbuild-std=core \
	--target $(TARGET)
else
$(error no Rust for $(TARGET); see the head of $(ROOT)/Makefile)
endif
else
override LIB := $(TARGET_DIR)/dist/libposewise.a
override CARGO_RUSTC := $(CARGO) rustc
endif
override NAME := $(or $(TARGET),$(shell rustc --print host-tuple))

# --- How to compile C for a machine and how to run it here.
ifeq ($(TARGET),)
CROSS_CC ?= $(CC)
CROSS_SIZE ?= size
else ifeq ($(TARGET),aarch64-unknown-linux-gnu)
CROSS_CC ?= aarch64-linux-gnu-gcc -static
CROSS_SIZE ?= aarch64-linux-gnu-size
RUN ?= timeout 300 qemu-aarch64-static -cpu cortex-a76
else ifeq ($(TARGET),armv7-unknown-linux-gnueabihf)
CROSS_CC ?= arm-linux-gnueabihf-gcc -static
CROSS_SIZE ?= arm-linux-gnueabihf-size
RUN ?= timeout 300 qemu-arm-static -cpu cortex-a7
# Rust's target of that name has no NEON, nearly every such processor has. RUSTFLAGS= does without.
export RUSTFLAGS := -Ctarget-feature=+neon
else ifeq ($(TARGET),thumbv7em-none-eabihf)
CROSS_CC ?= arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16
CROSS_SIZE ?= arm-none-eabi-size
# Files, standard output and the exit status go through the debugger's channel (semihosting).
BOARD := --specs=rdimon.specs -nostartfiles -Wl,--no-warn-execstack \
	-T $(ROOT)/ffi-examples/bare-metal/mps2-an386.ld \
	$(ROOT)/ffi-examples/bare-metal/start.c
RUN ?= timeout 300 qemu-system-arm -M mps2-an386 -nographic -monitor none -serial null \
	-semihosting-config enable=on,target=native,arg=replay,arg=$(CLIP),arg=$(FRAMES) -kernel
endif

# --- What is built in.
override PARTS := refiners verifier adaptation keyframes
ifneq ($(filter-out $(PARTS),$(WITHOUT)),)
$(error WITHOUT takes any of: $(PARTS))
endif
override comma := ,
override space := $(subst ,, )
override FEATURES := ffi panic-handler $(if $(filter none,$(MODEL)),,default-model) \
	$(filter-out $(WITHOUT),$(PARTS))
override FEATURES := $(subst $(space),$(comma),$(strip $(FEATURES)))

all: lib

# cargo knows best whether the library is fresh.
lib:
	cd $(ROOT) && $(CARGO_RUSTC) --quiet --profile dist --lib \
		$(if $(WITHOUT)$(filter none,$(MODEL)),--no-default-features) \
		--features $(FEATURES) --crate-type staticlib --target-dir $(abspath $(TARGET_DIR))

install: lib
	install -d $(addprefix $(DESTDIR)$(PREFIX)/,include share/posewise lib/pkgconfig lib/cmake/posewise)
	install -m 644 $(LIB) $(DESTDIR)$(PREFIX)/lib/
	install -m 644 $(ROOT)/include/posewise.h $(ROOT)/include/posewise.hpp $(DESTDIR)$(PREFIX)/include/
	install -m 644 $(ROOT)/models/default.posewise $(DESTDIR)$(PREFIX)/share/posewise/
	install -m 644 $(ROOT)/packaging/posewise-config.cmake $(DESTDIR)$(PREFIX)/lib/cmake/posewise/
	sed 's/@VERSION@/$(VERSION)/' $(ROOT)/packaging/posewise-config-version.cmake.in \
		> $(DESTDIR)$(PREFIX)/lib/cmake/posewise/posewise-config-version.cmake
	sed 's/@VERSION@/$(VERSION)/' $(ROOT)/packaging/posewise.pc.in \
		> $(DESTDIR)$(PREFIX)/lib/pkgconfig/posewise.pc

override PACKAGE := posewise-$(VERSION)-$(NAME)
dist:
	rm -rf $(TARGET_DIR)/package/$(PACKAGE)
	$(MAKE) -f $(ROOT)/Makefile install DESTDIR=$(abspath $(TARGET_DIR))/package/$(PACKAGE) PREFIX=
	install -m 644 $(ROOT)/LICENSE $(TARGET_DIR)/package/$(PACKAGE)/share/posewise/
	tar -C $(TARGET_DIR)/package --sort=name --owner=0 --group=0 --numeric-owner --mtime=@0 \
		-czf $(TARGET_DIR)/$(PACKAGE).tar.gz $(PACKAGE)
	@echo $(TARGET_DIR)/$(PACKAGE).tar.gz

override REPLAY := $(TARGET_DIR)/replay-$(NAME)
$(REPLAY): lib
	$(CROSS_CC) -std=c99 -O2 -Wall -Wextra -Wpedantic -Werror -I$(ROOT)/include $(ROOT)/tests/c/replay.c \
		$(BOARD) $(LIB) -Wl,--gc-sections -o $@

replay: $(REPLAY)
	@$(RUN) $(REPLAY) $(if $(BOARD),,$(CLIP) $(FRAMES)) </dev/null

# Linking takes what the header's functions reach; without posewise_default_model() no model.
override FUNCTIONS := $(filter-out posewise_default_model,$(shell \
	sed -n 's/^[a-z].*[ *]\(posewise_[a-z_]*\)(.*)*$$/\1/p' $(ROOT)/include/posewise.h))
size: lib
	$(CROSS_CC) -r -nostdlib -Wl,--gc-sections $(addprefix -Wl$(comma)-u$(comma),$(FUNCTIONS)) \
		$(LIB) -o $(TARGET_DIR)/whole-$(NAME).o
	$(CROSS_SIZE) $(TARGET_DIR)/whole-$(NAME).o

# The program tells model and memory, a Cortex-M's its stack; ten frames find and fit a face.
sizes:
	@echo '| built without | code and constants | model | tracker | stack of a program |'
	@echo '|---|---|---|---|---|'
	@for without in '' $(PARTS) '$(PARTS)'; do \
		$(MAKE) -s -f $(ROOT)/Makefile size replay WITHOUT="$$without" FRAMES=10 2>&1 | \
		awk -v without="$$without" ' \
			/text.*data.*bss/ { getline; code = $$1 + $$2 } \
			/^model: / { model = $$2 } \
			/^tracker: / { tracker = $$2 } \
			/^stack: / { stack = $$2 } \
			{ said = said $$0 "\n" } \
			END { \
				if (!code || !tracker) { print said; exit 1 } \
				print "| " (without ? without : "nothing") " | " code " | " model " | " \
					tracker " | " (stack ? stack : "-") " |" \
			}' || exit 1; \
	done

.PHONY: all lib install dist replay size sizes
