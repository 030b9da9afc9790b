#!/bin/sh
# camera.sh KERNEL PROGRAM CONTROL WORK - runs the V4L2 example in an emulated machine whose kernel
# has vivid, the kernel's own virtual camera (a test pattern), and prints what it prints.
#
# KERNEL is an unpacked Linux image (boot/, lib/modules/), PROGRAM ffi-examples/v4l2.c and CONTROL
# tests/c/control.c, both linked statically; WORK a folder for the machine's disk.
set -eu
kernel=$1 program=$2 control=$3 work=$4
rm -rf "$work"
mkdir -p "$work/bin" "$work/modules" "$work/proc" "$work/sys" "$work/dev"
cp "$(command -v busybox)" "$work/bin/busybox"
cp "$program" "$work/bin/v4l2"
cp "$control" "$work/bin/control"

# vivid and what it needs, in the order in which the kernel wants it.
order=
file_of() {
    find "$kernel/lib/modules" -name "$1.ko" -o -name "$(echo "$1" | tr _ -).ko" | head -n 1
}
add() {
    case " $order " in *" $1 "*) return ;; esac
    for needed in $(tr '\0' '\n' <"$(file_of "$1")" | sed -n 's/^depends=//p' | tr , ' '); do
        add "$needed"
    done
    cp "$(file_of "$1")" "$work/modules/$1.ko"
    order="$order $1"
}
add vivid

cat >"$work/init" <<INIT
#!/bin/busybox sh
/bin/busybox --install -s /bin
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs dev /dev
for module in $order; do
    options=
    [ \$module != vivid ] || options="n_devs=1 node_types=0x1 num_inputs=1 input_types=0"
    insmod /modules/\$module.ko \$options
done
run() {
    echo "== \$*"
    "\$@" 2>&1
    echo "== status \$?"
}
for format in GREY NV12 YUYV; do
    run v4l2 /dev/video0 5 \$format
done
run v4l2 /dev/video0 3
run v4l2 /dev/video0 3 H264
run v4l2 /dev/video9 3
# What comes while it runs, after some frames.
during() {
    echo "== \$*"
    rm -f /lines && touch /lines
    v4l2 /dev/video0 >/lines 2>/words &
    while [ "\$(wc -l </lines)" -lt 3 ]; do sleep 0.1; done
    before=\$(wc -l </lines)
    "\$@" \$!
    if [ \$1 = spoil ]; then
        while [ "\$(wc -l </lines)" -lt \$((before + 3)) ]; do sleep 0.1; done
        kill -INT \$!
    fi
    wait \$!
    status=\$?
    cat /lines /words
    echo "== status \$status"
}
interrupt() { kill -INT \$1; }
spoil() { control /dev/video0 "Inject V4L2_BUF_FLAG_ERROR"; }
unplug() { control /dev/video0 Disconnect; }
during interrupt
during spoil
during unplug
poweroff -f
INIT
chmod +x "$work/init"
(cd "$work" && find . | cpio --quiet -o -H newc | gzip -1) >"$work.cpio.gz"
# Without KVM: it is not there in many containers, and seconds are enough.
exec timeout 300 qemu-system-x86_64 -M pc -m 512 -nographic -no-reboot -nic none \
    -kernel "$(find "$kernel/boot" -name 'vmlinuz-*' | head -n 1)" -initrd "$work.cpio.gz" \
    -append "console=ttyS0 panic=-1 quiet" </dev/null
