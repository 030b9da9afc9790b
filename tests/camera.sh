#!/bin/sh
# camera.sh KERNEL V4L2 DRIVER CONTROL FEED CLIP WORK - runs the V4L2 examples in an emulated
# machine whose kernel has vivid, the kernel's own virtual video device, and prints what they print.
#
# There, /dev/video0 is a camera that shows a test pattern; what is shown on the output /dev/video2
# comes in at /dev/video1. KERNEL is an unpacked Linux image (boot/, lib/modules/); V4L2,
# DRIVER, CONTROL and FEED are two of ffi-examples and two of tests/c, linked statically; CLIP is a
# grey y4m file, WORK a folder for the machine's disk.
set -eu
kernel=$1 v4l2=$2 driver=$3 control=$4 feed=$5 clip=$6 work=$7
rm -rf "$work"
mkdir -p "$work/bin" "$work/modules" "$work/proc" "$work/sys" "$work/dev"
cp "$(command -v busybox)" "$work/bin/busybox"
cp "$v4l2" "$work/bin/v4l2"
cp "$driver" "$work/bin/driver"
cp "$control" "$work/bin/control"
cp "$feed" "$work/bin/feed"
cp "$clip" "$work/clip.y4m"

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
    [ \$module != vivid ] || options="n_devs=2 node_types=0x1,0x101 num_inputs=1,1 input_types=0,3
        num_outputs=1,1 output_types=1,1" # a webcam; HDMI in and out
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
run v4l2 /dev/video0 3 - face
run v4l2 /dev/video9 3
run driver 0 /dev/video0 5
run driver 0 /dev/video9 5
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
control /dev/video1 "Loop Video"
feed /dev/video2 /clip.y4m &
sleep 1
run v4l2 /dev/video1 100 GREY
poweroff -f
INIT
chmod +x "$work/init"
(cd "$work" && find . | cpio --quiet -o -H newc | gzip -1) >"$work.cpio.gz"
# loglevel: no kernel message amid a line. Without KVM: many containers have none, and seconds do.
exec timeout 900 qemu-system-x86_64 -M pc -m 512 -nographic -no-reboot -nic none \
    -kernel "$(find "$kernel/boot" -name 'vmlinuz-*' | head -n 1)" -initrd "$work.cpio.gz" \
    -append "console=ttyS0 panic=-1 quiet loglevel=1" </dev/null
