// cv_mat.cpp FRAMES WIDTH HEIGHT - a cv::Mat of each type, and a region of one, gives what a plain
// frame gives.
#include "../../ffi-examples/cv_mat.hpp"
#include "check.h"

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

// The grey picture with this many equal channels, within a larger picture.
static cv::Mat region(const cv::Mat &grey, int type) {
    cv::Mat larger(grey.rows + 7, grey.cols + 9, type, cv::Scalar::all(40));
    cv::Mat inner = larger(cv::Rect(3, 2, grey.cols, grey.rows));
    const int channels = inner.channels();
    for (int y = 0; y < grey.rows; y++)
        for (int x = 0; x < grey.cols; x++)
            for (int c = 0; c < channels; c++)
                inner.ptr<std::uint8_t>(y)[x * channels + c] = grey.at<std::uint8_t>(y, x);
    return inner;
}

int main(int argc, char **argv) {
    if (argc != 4)
        return 2;
    std::ifstream file(argv[1], std::ios::binary);
    std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    const int width = std::atoi(argv[2]), height = std::atoi(argv[3]);
    cv::Mat image(height, width, CV_8UC1, bytes.data());
    posewise_result expected = posewise::result();
    posewise::Tracker plain(posewise::Model::built_in());
    const posewise_frame frame = posewise::grey(image.data, static_cast<std::uint32_t>(width),
                                                static_cast<std::uint32_t>(height), 1);
    CHECK(plain.step(frame, expected) == POSEWISE_OK);
    for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4}) {
        posewise::Tracker tracker(posewise::Model::built_in());
        posewise_result result = posewise::result();
        CHECK(tracker.step(cv_mat::frame(region(image, type), 1), result) == POSEWISE_OK);
        CHECK(result.state == expected.state);
        CHECK(std::abs(result.yaw_deg - expected.yaw_deg) < 0.5f);
    }
    posewise_result result = posewise::result();
    posewise::Tracker tracker(posewise::Model::built_in());
    const cv::Mat deep(height, width, CV_16UC1, cv::Scalar::all(0)), real(height, width, CV_32FC1);
    CHECK(tracker.step(cv_mat::frame(deep, 1), result) == POSEWISE_OK);
    CHECK(tracker.step(cv_mat::frame(real, 2), result) == POSEWISE_E_FORMAT);
    CHECK(tracker.step(cv_mat::frame(cv::Mat(), 2), result) < 0);
    return failures;
}
