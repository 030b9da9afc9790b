/* A plugin of QEMU (user mode, 7.2 or later) that counts the instructions of a program, and which
 * of its accesses miss two levels of cache, of which the first is one for data and one for code:
 * qemu-aarch64 -plugin libcount.so,l1d=32:4,l1i=32:2,l2=512:16,paths=9000:1000 -d plugin PROGRAM
 * with KiB and ways of each cache. It also prints the code of paths: 2000 instructions as they run,
 * here from the 9000th on and again after every 1000; none after 0. The declarations are those of
 * QEMU's qemu-plugin.h, version 1, which Debian does not package. */
#include <inttypes.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef uint64_t qemu_plugin_id_t;
typedef uint32_t qemu_plugin_meminfo_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t,
                                           void (*)(qemu_plugin_id_t, struct qemu_plugin_tb *));
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *,
                                          void (*)(unsigned int, void *), int flags, void *);
void qemu_plugin_register_vcpu_mem_cb(struct qemu_plugin_insn *,
                                      void (*)(unsigned int, qemu_plugin_meminfo_t, uint64_t,
                                               void *),
                                      int flags, int kinds, void *);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t, void (*)(qemu_plugin_id_t, void *), void *);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
uint64_t qemu_plugin_tb_vaddr(const struct qemu_plugin_tb *);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *, size_t);
const void *qemu_plugin_insn_data(const struct qemu_plugin_insn *);
size_t qemu_plugin_insn_size(const struct qemu_plugin_insn *);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *);
unsigned int qemu_plugin_mem_size_shift(qemu_plugin_meminfo_t);
void qemu_plugin_outs(const char *);

int qemu_plugin_version = 1;

enum { LOADS_AND_STORES = 3, LINE = 64, PAGE = 4096, LONGEST = 15, PATH = 2000 };

/* Sets of lines, the one used last first. A line is its address / LINE + 1; 0 is none. */
struct cache {
    const char *name;
    size_t ways, sets;
    uint64_t *lines, misses;
};

static struct cache l1d = {"l1d", 0, 0, NULL, 0}, l1i = {"l1i", 0, 0, NULL, 0},
                    l2 = {"l2", 0, 0, NULL, 0};

static bool hits(struct cache *cache, uint64_t line) {
    uint64_t *set = cache->lines + line % cache->sets * cache->ways;
    size_t at = 0;
    bool hit;
    while (at < cache->ways - 1 && set[at] != line + 1)
        at++;
    hit = set[at] == line + 1;
    memmove(set + 1, set, at * sizeof *set);
    set[0] = line + 1;
    cache->misses += !hit;
    return hit;
}

static void touch(struct cache *first, uint64_t address, uint64_t bytes) {
    for (uint64_t line = address / LINE; line <= (address + bytes - 1) / LINE; line++)
        if (!hits(first, line))
            hits(&l2, line);
}

struct block {
    uint64_t address, bytes, instructions;
    char *code; /* one instruction a word, in hexadecimal digits */
};

static uint64_t instructions, next_path, every;
static uint64_t left; /* instructions until the path ends */

static void accessed(unsigned int cpu, qemu_plugin_meminfo_t info, uint64_t address, void *unused) {
    (void)cpu;
    (void)unused;
    touch(&l1d, address, UINT64_C(1) << qemu_plugin_mem_size_shift(info));
}

static void executed(unsigned int cpu, void *data) {
    const struct block *block = data;
    (void)cpu;
    touch(&l1i, block->address, block->bytes);
    instructions += block->instructions;
    if (left > 0) {
        qemu_plugin_outs(block->code);
        left -= block->instructions < left ? block->instructions : left;
        if (left == 0)
            qemu_plugin_outs("\n");
    } else if (every > 0 && instructions >= next_path) {
        qemu_plugin_outs("path ");
        left = PATH;
        next_path += every;
    }
}

static void translated(qemu_plugin_id_t id, struct qemu_plugin_tb *tb) {
    struct block *block = calloc(1, sizeof *block);
    char *code;
    (void)id;
    block->address = qemu_plugin_tb_vaddr(tb);
    block->instructions = qemu_plugin_tb_n_insns(tb);
    for (size_t n = 0; n < block->instructions; n++)
        block->bytes += qemu_plugin_insn_size(qemu_plugin_tb_get_insn(tb, n));
    block->code = code = malloc(2 * block->bytes + block->instructions + 1);
    for (size_t n = 0; n < block->instructions; n++) {
        struct qemu_plugin_insn *instruction = qemu_plugin_tb_get_insn(tb, n);
        const uint8_t *data = qemu_plugin_insn_data(instruction);
        const size_t bytes = qemu_plugin_insn_size(instruction);
        /* Of one of x86 that goes on in the next page QEMU shows only a part. */
        if (qemu_plugin_insn_vaddr(instruction) % PAGE <= PAGE - LONGEST) {
            for (size_t byte = 0; byte < bytes; byte++)
                code += sprintf(code, "%02x", data[byte]);
            *code++ = ' ';
        }
        qemu_plugin_register_vcpu_mem_cb(instruction, accessed, 0, LOADS_AND_STORES, NULL);
    }
    *code = 0;
    qemu_plugin_register_vcpu_tb_exec_cb(tb, executed, 0, block);
}

static void ended(qemu_plugin_id_t id, void *unused) {
    char line[256];
    (void)id;
    (void)unused;
    snprintf(line, sizeof line,
             "\ninstructions %" PRIu64 "\nl1d %" PRIu64 "\nl1i %" PRIu64 "\nl2 %" PRIu64 "\n",
             instructions, l1d.misses, l1i.misses, l2.misses);
    qemu_plugin_outs(line);
}

static bool made(struct cache *cache, int argc, char **argv) {
    const size_t name = strlen(cache->name);
    unsigned kib, ways;
    for (int n = 0; n < argc; n++) {
        if (strncmp(argv[n], cache->name, name) == 0 &&
            sscanf(argv[n] + name, "=%u:%u", &kib, &ways) == 2 && ways != 0) {
            cache->ways = ways;
            cache->sets = (size_t)kib * 1024 / LINE / ways;
            cache->lines = calloc(cache->sets * ways, sizeof *cache->lines);
        }
    }
    return cache->lines != NULL && cache->sets != 0;
}

int qemu_plugin_install(qemu_plugin_id_t id, const void *info, int argc, char **argv) {
    (void)info;
    for (int n = 0; n < argc; n++)
        sscanf(argv[n], "paths=%" SCNu64 ":%" SCNu64, &next_path, &every);
    if (!made(&l1d, argc, argv) || !made(&l1i, argc, argv) || !made(&l2, argc, argv))
        return 1;
    qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
    qemu_plugin_register_atexit_cb(id, ended, NULL);
    return 0;
}
