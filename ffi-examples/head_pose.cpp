// head_pose.cpp - uses the C++ wrapper: tracks 8-bit grey frames from standard input.
//
//     ffmpeg -v error -i face.mp4 -f rawvideo -pix_fmt gray - | ./head_pose WIDTH HEIGHT [FPS]
#include "posewise.hpp"

#include <cstdio>
#include <cstdlib>
#include <vector>

int main(int argc, char **argv) {
    const unsigned long width = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 0;
    const unsigned long height = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 0;
    const double fps = argc > 3 ? std::strtod(argv[3], nullptr) : 30.0;
    if (width < 1 || width > 16384 || height < 1 || height > 16384 || !(fps > 0.0)) {
        std::fprintf(stderr, "usage: head_pose WIDTH HEIGHT [FPS] < grey frames\n");
        return 2;
    }
    posewise::Tracker tracker(posewise::Model::built_in());
    if (!tracker) {
        std::fprintf(stderr, "head_pose: %s\n", tracker.message());
        return 1;
    }
    std::vector<std::uint8_t> pixels(width * height);
    posewise_result pose = posewise::result();
    for (long i = 0; std::fread(pixels.data(), 1, pixels.size(), stdin) == pixels.size(); i++) {
        const auto time_us = static_cast<std::int64_t>(static_cast<double>(i) * 1e6 / fps);
        const posewise_frame frame =
            posewise::grey(pixels.data(), static_cast<std::uint32_t>(width),
                           static_cast<std::uint32_t>(height), time_us);
        if (const posewise_status status = tracker.step(frame, pose); status < 0) {
            std::fprintf(stderr, "head_pose: frame %ld: %s\n", i, posewise_strerror(status));
            return 1;
        }
        if (pose.state == POSEWISE_SEARCHING)
            std::printf("%ld -\n", i);
        else
            std::printf("%ld yaw %.1f pitch %.1f roll %.1f at %.0f %.0f %.0f mm\n", i,
                        static_cast<double>(pose.yaw_deg), static_cast<double>(pose.pitch_deg),
                        static_cast<double>(pose.roll_deg),
                        static_cast<double>(pose.translation_mm[0]),
                        static_cast<double>(pose.translation_mm[1]),
                        static_cast<double>(pose.translation_mm[2]));
    }
    return 0;
}
