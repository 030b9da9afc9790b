# The libraries with their C ABI, and their package.
#
#   make            builds target/dist/lib/libposewise.a and, on Linux, libposewise.so beside it;
#                   for another machine in target/TARGET/dist/…
#   make install    installs libraries, headers, model, pkg-config and CMake files; for this machine
#                   also the command with its manual pages and completions
#   make uninstall  removes what install put there
#   make dist       packs what is installed: target/posewise-VERSION-TARGET.tar.gz
#   make release    makes every package that this machine has the tools for, with checksums, in
#                   target/packages
#   make wasm       builds the modules of web/: target/wasm/posewise*.wasm
#
#   PREFIX=…        where to install (/usr/local)
#   LIBDIR=…        the libraries' folder in PREFIX (lib)
#   DESTDIR=…       a folder before PREFIX, for packagers
#   TARGET=…        another machine, by its name in Rust; what it needs is in docs/integrating.md
#   MODEL=none      builds no model in
#   WITHOUT="…"     leaves out any of the default features of Cargo.toml; see docs/memory.md
#   TARGET_DIR=…    cargo's build folder (target)
#   SHARED=none     builds no shared library
#   LIBC=none       the shared one names no C library: it fits programs with glibc and with musl
#   COMMAND=…       the command is built already, at this path; none installs none
#   BINUTILS=…      prefix of ld, objcopy and ar for TARGET; known for the machines of the tests
#
# What developers measure (sizes, results on emulated machines) is in `cargo xtask --help`.

TARGET_DIR ?= $(or $(CARGO_TARGET_DIR),target)
PREFIX ?= /usr/local
LIBDIR ?= lib
CARGO ?= cargo
override ROOT := $(abspath $(dir $(lastword $(MAKEFILE_LIST))))
override MANIFEST := $(ROOT)/Cargo.toml
override VERSION := $(shell sed -n 's/^version = "\(.*\)"/\1/p' $(MANIFEST))
override DIST := $(abspath $(TARGET_DIR))/$(if $(TARGET),$(TARGET)/)dist
override LIB := $(DIST)/lib/libposewise.a
# Programs remember the shared library by this name: one that changes the ABI has another.
override ABI := $(shell sed -n 's/^pub const POSEWISE_ABI: u32 = \(.*\);/\1/p' \
	$(ROOT)/src/ffi/types.rs)
override SONAME := libposewise.so.$(ABI)

# Features: the default ones, less what is left out.
override DEFAULT := $(shell sed -n 's/^default = \[\(.*\)\]$$/\1/p' $(MANIFEST) | tr -d '",')
override PARTS := $(filter-out default-model,$(DEFAULT))
override UNWANTED := $(WITHOUT) $(if $(filter none,$(MODEL)),default-model)
override FEATURES := ffi panic-handler $(filter-out $(UNWANTED),$(DEFAULT))
$(if $(filter-out $(PARTS),$(WITHOUT)),$(error WITHOUT takes any of: $(PARTS)))

# Another machine: where the compiler has no core library for it, core is built from its source,
# with rustup's compiler or else with Debian's (each cargo builds only the core of its own version).
ifdef TARGET
override RUSTLIB = $(shell $(1) --print sysroot)/lib/rustlib
override CORE_SOURCE = $(wildcard $(call RUSTLIB,$(1))/src/rust/library/core/src/lib.rs)
ifeq ($(wildcard $(call RUSTLIB,rustc)/$(TARGET)/lib/libcore-*.rlib),)
override BUILD_CORE := -Zbuild-std=core
export RUSTC_BOOTSTRAP := 1
ifeq ($(call CORE_SOURCE,rustc),)
$(if $(call CORE_SOURCE,/usr/bin/rustc),,$(error no Rust for $(TARGET); see docs/integrating.md))
override CARGO := /usr/bin/cargo
export RUSTC := /usr/bin/rustc
endif
endif
endif
ifeq ($(TARGET),armv7-unknown-linux-gnueabihf)
# Rust's target of that name has no NEON, nearly every such processor has. RUSTFLAGS= does without.
export RUSTFLAGS := -Ctarget-feature=+neon
endif

# With the machine's binutils, all symbols but posewise_* become local. Without them (Apple) the
# archive stays as cargo makes it: the functions of Rust's compiler_builtins are visible.
BINUTILS_aarch64-unknown-linux-gnu := aarch64-linux-gnu-
BINUTILS_armv7-unknown-linux-gnueabihf := arm-linux-gnueabihf-
BINUTILS_thumbv7em-none-eabihf := arm-none-eabi-
BINUTILS_x86_64-pc-windows-gnu := x86_64-w64-mingw32-
BINUTILS_aarch64-linux-android := aarch64-linux-gnu-
BINUTILS_x86_64-linux-android := x86_64-linux-gnu-
BINUTILS ?= $(BINUTILS_$(TARGET))
override TOOL = $(shell command -v $(BINUTILS)$(1))
ifneq ($(BINUTILS)$(if $(TARGET),,$(filter Linux,$(shell uname -s))),)
override CAN_HIDE := $(and $(call TOOL,ld),$(call TOOL,objcopy),$(call TOOL,ar))
endif

# The shared library is linked on Linux, by the C compiler, from the object in which all symbols but
# posewise_* are local. Of the C library it needs memcpy, memmove, memset and memcmp; with LIBC=none
# it takes those of the program, whichever its C library is, and no version of one is asked for.
override LINKER := $(if $(TARGET),$(BINUTILS)gcc,$(CC))
override CAN_SHARE := $(and $(CAN_HIDE),$(if $(filter none,$(SHARED)),,yes),$(if \
	$(TARGET),$(findstring linux-gnu,$(TARGET)),yes),$(shell command -v $(firstword $(LINKER))))
override LINK_SHARED = $(LINKER) -shared -nostartfiles -s -Wl,-soname,$(SONAME) \
	$(if $(filter none,$(LIBC)),-nostdlib,-Wl,-z,defs) \
	-Wl,-z,relro -Wl,-z,now -Wl,-z,noexecstack -Wl,--gc-sections

# Cargo knows whether the library is up to date. The file is replaced by renaming, because two runs
# of make may share a folder. One object of the archive has all functions, and needs few others.
# Bitcode in the others (.llvmbc) would make binutils with LLVM's plugin see nothing else.
# Nothing unwinds here: without ARM's tables no function of Rust that would is asked for.
lib:
	cd $(ROOT) && $(CARGO) rustc --quiet --profile dist --lib --crate-type staticlib \
		$(if $(strip $(UNWANTED)),--no-default-features) --features "$(FEATURES)" \
		$(BUILD_CORE) $(if $(TARGET),--target $(TARGET)) --target-dir $(abspath $(TARGET_DIR))
	mkdir -p $(DIST)/lib
	temporary=$$(mktemp -d $(DIST)/lib.XXXXXX) && trap 'rm -rf $$temporary' EXIT && \
	cd $$temporary && cp ../libposewise.a . && \
	$(if $(CAN_HIDE),$(BINUTILS)objcopy -R .llvmbc -R .llvmcmd libposewise.a && \
		$(BINUTILS)ld -r -u posewise_version -o posewise.o libposewise.a && \
		$(BINUTILS)objcopy --wildcard --keep-global-symbol='posewise_*' \
			-R '.ARM.ex*' -N rust_eh_personality posewise.o && \
		rm libposewise.a && $(BINUTILS)ar rcsD libposewise.a posewise.o &&) \
	$(if $(CAN_SHARE),$(LINK_SHARED) -o $(SONAME) posewise.o && \
		mv $(SONAME) $(DIST)/lib/$(SONAME) &&) \
	mv libposewise.a $(LIB)

# The licences of what is linked in, written anew when the crates change. The environment may be
# that of another machine.
override NOTICES := $(ROOT)/packaging/NOTICES.txt
notices: $(NOTICES)
$(NOTICES): $(ROOT)/Cargo.lock
	cd $(ROOT) && env -u RUSTC -u RUSTC_BOOTSTRAP -u RUSTFLAGS cargo xtask notices

override TO := $(DESTDIR)$(PREFIX)
override TO_LIB := $(TO)/$(LIBDIR)
override CMAKE := $(TO_LIB)/cmake/posewise
# From a folder in LIBDIR to PREFIX.
override EMPTY :=
override UP := $(subst $(EMPTY) $(EMPTY),/,$(patsubst %,..,$(subst /, ,$(LIBDIR)/folder)))
override FILL = sed 's|@VERSION@|$(VERSION)|; s|@LIBDIR@|$(LIBDIR)|; s|@UP@|$(UP)|'
install: lib notices $(if $(TARGET)$(filter none,$(COMMAND)),,install-command)
	install -d $(TO)/include $(TO)/share/posewise $(TO_LIB)/pkgconfig $(CMAKE)
	install -m 644 $(LIB) $(TO_LIB)/
	$(if $(CAN_SHARE),install -m 755 $(DIST)/lib/$(SONAME) $(TO_LIB)/)
	$(if $(CAN_SHARE),ln -sf $(SONAME) $(TO_LIB)/libposewise.so)
	install -m 644 $(ROOT)/include/posewise.h $(ROOT)/include/posewise.hpp $(TO)/include/
	install -m 644 $(ROOT)/models/posewise.posewise $(ROOT)/models/posewise.md $(ROOT)/LICENSE \
		$(NOTICES) $(TO)/share/posewise/
	$(FILL) $(ROOT)/packaging/posewise-config.cmake.in > $(CMAKE)/posewise-config.cmake
	$(FILL) $(ROOT)/packaging/posewise-config-version.cmake.in \
		> $(CMAKE)/posewise-config-version.cmake
	$(FILL) $(ROOT)/packaging/posewise.pc.in > $(TO_LIB)/pkgconfig/posewise.pc
	$(if $(CAN_SHARE),$(FILL) $(ROOT)/packaging/posewise-shared.pc.in \
		> $(TO_LIB)/pkgconfig/posewise-shared.pc)

install-command: notices
	$(if $(COMMAND),,cd $(ROOT) && $(CARGO) build --quiet --release --bin posewise \
		--target-dir $(abspath $(TARGET_DIR)))
	install -d $(TO)/bin $(TO)/share/posewise
	install -m 644 $(ROOT)/packaging/NOTICES-command.txt $(TO)/share/posewise/
	install -s -m 755 $(or $(COMMAND),$(TARGET_DIR)/release/posewise) $(TO)/bin/posewise
	$(TO)/bin/posewise manual $(TO)/share

uninstall:
	rm -f $(TO)/bin/posewise $(TO)/share/man/man1/posewise.1 $(TO)/share/man/man1/posewise-*.1
	rm -f $(TO)/share/zsh/site-functions/_posewise $(addprefix $(TO)/share/,\
		bash-completion/completions/posewise.bash fish/vendor_completions.d/posewise.fish)
	rm -f $(TO_LIB)/libposewise.a $(TO_LIB)/libposewise.so $(TO_LIB)/$(SONAME)
	rm -f $(TO_LIB)/pkgconfig/posewise.pc $(TO_LIB)/pkgconfig/posewise-shared.pc
	rm -f $(TO)/include/posewise.h $(TO)/include/posewise.hpp
	rm -rf $(TO)/share/posewise $(CMAKE)

override PACKAGE = posewise-$(VERSION)-$(or $(TARGET),$(shell rustc --print host-tuple))
override STAGE = $(abspath $(TARGET_DIR))/package/$(PACKAGE)
dist:
	rm -rf $(STAGE)
	$(MAKE) -f $(ROOT)/Makefile install DESTDIR=$(STAGE) PREFIX=
	tar -C $(STAGE)/.. --sort=name --owner=0 --group=0 --numeric-owner \
		--mtime=@$(or $(SOURCE_DATE_EPOCH),0) -czf $(TARGET_DIR)/$(PACKAGE).tar.gz $(PACKAGE)
	@echo $(TARGET_DIR)/$(PACKAGE).tar.gz

# The library in WebAssembly, without SIMD, with it and with relaxed SIMD, and no model built in.
# RUSTFLAGS reach all crates; each set of flags has its own build folder, so that all stay up to
# date.
override WASM := $(abspath $(TARGET_DIR))/wasm
override WASM_MAKE := $(MAKE) --no-print-directory -f $(ROOT)/Makefile wasm-module MODEL=none \
	TARGET=wasm32-unknown-unknown
wasm:
	+$(WASM_MAKE) TARGET_DIR=$(WASM)/plain NAME=posewise
	+$(WASM_MAKE) TARGET_DIR=$(WASM)/simd128 NAME=posewise-simd128 FLAGS=-Ctarget-feature=+simd128
	+$(WASM_MAKE) TARGET_DIR=$(WASM)/relaxed NAME=posewise-relaxed \
		FLAGS=-Ctarget-feature=+simd128,+relaxed-simd

# Debian's Rust has no linker for WebAssembly of its own; package lld has one.
wasm-module:
	$(if $(BUILD_CORE),$(if $(shell command -v wasm-ld),,$(error no wasm-ld: package lld)))
	cd $(ROOT) && RUSTFLAGS="-Cstrip=symbols $(FLAGS) $(if $(BUILD_CORE),-Clinker=wasm-ld)" \
	$(CARGO) rustc --quiet --profile dist --lib --crate-type cdylib --no-default-features \
		--features "$(FEATURES)" $(BUILD_CORE) --target $(TARGET) --target-dir $(TARGET_DIR)
	cp $(DIST)/posewise.wasm $(TARGET_DIR)/../$(NAME).wasm

# Everything that can be packed here, with checksums.
release:
	$(CARGO) xtask release

.PHONY: lib notices install install-command uninstall dist wasm wasm-module
