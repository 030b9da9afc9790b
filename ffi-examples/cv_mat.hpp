// cv_mat.hpp - a cv::Mat as a frame, without a copy, in one line:
//
//     tracker.step(cv_mat::frame(image, time_us), result);
//
// The Mat must live until the call ends. Of colour images only luma is computed, as they are read.
#ifndef CV_MAT_HPP
#define CV_MAT_HPP

#include "posewise.hpp"

#include <opencv2/core.hpp>

namespace cv_mat {

// CV_8UC1 is grey, CV_8UC3 BGR, CV_8UC4 BGRA, CV_16UC1 16-bit grey. Other types give a frame that
// posewise_step() refuses with POSEWISE_E_FORMAT.
inline posewise_frame frame(const cv::Mat &image, std::int64_t timestamp_us) {
    posewise_frame f = posewise::frame();
    switch (image.type()) {
    case CV_8UC1: f.format = POSEWISE_FMT_GREY; break;
    case CV_8UC3: f.format = POSEWISE_FMT_BGR3; break;
    case CV_8UC4: f.format = POSEWISE_FMT_AR24; break;
    case CV_16UC1: f.format = POSEWISE_FMT_Y16; break;
    default: break;
    }
    f.timestamp_us = timestamp_us;
    f.width = static_cast<std::uint32_t>(image.cols);
    f.height = static_cast<std::uint32_t>(image.rows);
    f.stride = static_cast<std::uint32_t>(image.step[0]);
    // The last row of a region of a larger image is not followed by a whole stride.
    f.data_len = image.empty() ? 0
                               : image.step[0] * static_cast<std::size_t>(image.rows - 1) +
                                     image.elemSize() * static_cast<std::size_t>(image.cols);
    f.data = image.data;
    return f;
}

} // namespace cv_mat

#endif
