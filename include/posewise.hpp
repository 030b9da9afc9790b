// posewise.hpp - posewise.h for C++17: a tracker that owns its memory and borrows its model, and a
// driver monitor.
//
// Header only. Throws no exceptions: functions that can fail return a posewise_status, and a
// tracker whose creation failed converts to false. Units, ranges and frames are those of
// posewise.h.
#ifndef POSEWISE_HPP
#define POSEWISE_HPP

#include "posewise.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

namespace posewise {

using Landmarks = std::array<posewise_landmark, POSEWISE_LANDMARKS>;
using Events = std::array<posewise_event, POSEWISE_EVENTS>;
using MeshVertices = std::array<posewise_mesh_vertex, POSEWISE_MESH_VERTICES>;
using Animation = std::array<float, POSEWISE_ANIMATIONS>;
using MonitorEvents = std::array<posewise_monitor_event, POSEWISE_MONITOR_EVENTS>;

// Structs with struct_size set and all other fields 0, their defaults.
inline posewise_config config() { return POSEWISE_CONFIG_INIT; }
inline posewise_frame frame() { return POSEWISE_FRAME_INIT; }
inline posewise_hint hint() { return POSEWISE_HINT_INIT; }
inline posewise_result result() { return POSEWISE_RESULT_INIT; }
inline posewise_model_details model_details() { return POSEWISE_MODEL_DETAILS_INIT; }
inline posewise_mesh_topology mesh_topology() { return POSEWISE_MESH_TOPOLOGY_INIT; }
inline posewise_monitor_config monitor_config() { return POSEWISE_MONITOR_CONFIG_INIT; }
inline posewise_monitor_observation monitor_observation() {
    return POSEWISE_MONITOR_OBSERVATION_INIT;
}
inline posewise_monitor_state monitor_state() { return POSEWISE_MONITOR_STATE_INIT; }

// A grey image without padding between rows.
inline posewise_frame grey(const std::uint8_t *data, std::uint32_t width, std::uint32_t height,
                           std::int64_t timestamp_us) {
    posewise_frame f = frame();
    f.format = POSEWISE_FMT_GREY;
    f.timestamp_us = timestamp_us;
    f.width = width;
    f.height = height;
    f.stride = width;
    f.data_len = static_cast<std::size_t>(width) * height;
    f.data = data;
    return f;
}

// A model in memory: POSEWISE_ALIGN-aligned bytes that outlive every tracker.
struct Model {
    const void *data = nullptr;
    std::size_t size = 0;

    // The model built into the library; empty if there is none.
    static Model built_in() {
        Model m;
        m.data = posewise_default_model(&m.size);
        return m;
    }

    posewise_status check() const { return posewise_model_check(data, size); }

    posewise_status info(posewise_model_details &out) const {
        return posewise_model_info(data, size, &out);
    }
};

// Tracks one face of one camera. Movable; copy() gives a second, independent tracker.
class Tracker {
public:
    // No tracker.
    Tracker() = default;

    explicit Tracker(Model model, const posewise_config &config = posewise::config()) {
        size_ = posewise_memory_size(&config);
        if (size_ == 0) {
            // The settings are checked before the memory: this gives their error.
            status_ = posewise_init(&tracker_, this, 0, model.data, model.size, &config);
            return;
        }
        memory_ = allocate(size_);
        status_ = memory_ ? posewise_init(&tracker_, memory_.get(), size_, model.data, model.size,
                                          &config)
                          : POSEWISE_E_MEMORY;
    }

    Tracker(Tracker &&other) noexcept { swap(other); }
    Tracker &operator=(Tracker &&other) noexcept {
        Tracker taken(std::move(other));
        swap(taken);
        return *this;
    }

    // Whether there is a tracker; if not, status() and message() give the error.
    explicit operator bool() const { return tracker_ != nullptr; }
    posewise_status status() const { return status_; }
    const char *message() const { return posewise_strerror(status_); }

    posewise_status step(const posewise_frame &frame, posewise_result &out) {
        return posewise_step(tracker_, &frame, &out);
    }

    // As step(), for a face that is expected at the hint.
    posewise_status step_at(const posewise_frame &frame, const posewise_hint &hint,
                            posewise_result &out) {
        return posewise_step_at(tracker_, &frame, &hint, &out);
    }

    posewise_status landmarks(Landmarks &out) const {
        return posewise_landmarks(tracker_, out.data(), out.size());
    }

    posewise_status animation(Animation &out) const {
        return posewise_animation(tracker_, out.data(), out.size());
    }

    // The last result, smoothed over time.
    posewise_status smoothed(posewise_result &out) const {
        return posewise_smoothed(tracker_, &out);
    }

    posewise_status smoothed_landmarks(Landmarks &out) const {
        return posewise_smoothed_landmarks(tracker_, out.data(), out.size());
    }

    posewise_status smoothed_animation(Animation &out) const {
        return posewise_smoothed_animation(tracker_, out.data(), out.size());
    }

    // The vertices of the dense mesh in a space POSEWISE_MESH_SPACE_*; count are written.
    posewise_status mesh(std::uint32_t space, MeshVertices &out, std::size_t &count) const {
        return posewise_mesh(tracker_, space, out.data(), out.size(), &count);
    }

    // Those of the person's own head, head frame: POSEWISE_MESH_NEUTRAL, or one weight at 1.
    posewise_status mesh_shape(std::uint32_t shape, MeshVertices &out, std::size_t &count) const {
        return posewise_mesh_shape(tracker_, shape, out.data(), out.size(), &count);
    }

    // How they are joined: tables that lie in the model.
    posewise_status mesh_tables(posewise_mesh_topology &out) const {
        return posewise_mesh_tables(tracker_, &out);
    }

    // Takes the unread events, oldest first, and counts those that were overwritten unread.
    posewise_status events(Events &out, std::size_t &count, std::size_t &overwritten) {
        return posewise_events(tracker_, out.data(), out.size(), &count, &overwritten);
    }

    posewise_status set_intrinsics(const posewise_intrinsics &camera) {
        return posewise_set_intrinsics(tracker_, &camera);
    }

    posewise_status set_lens(const posewise_lens &lens) {
        return posewise_set_lens(tracker_, &lens);
    }

    // Where faces are searched for from the next step on; all zero: the whole frame.
    posewise_status set_roi(const posewise_roi &roi) { return posewise_set_roi(tracker_, &roi); }

    // Boxes x, y, width, height of faces that other trackers follow.
    posewise_status set_excluded(const float *boxes, std::size_t count) {
        return posewise_set_excluded(tracker_, boxes, count);
    }

    // Faces of a frame; see posewise.h.
    posewise_status detect(const posewise_frame &frame, posewise_face *out, std::size_t capacity,
                           std::size_t &count, std::uint32_t &finished) {
        return posewise_detect(tracker_, &frame, out, capacity, &count, &finished);
    }

    posewise_status reset() { return posewise_reset(tracker_); }

    posewise_status forget_identity() { return posewise_forget_identity(tracker_); }

    // What was learnt of the person's head, for the next time.
    posewise_status
    save_identity(std::array<uint8_t, POSEWISE_IDENTITY_RECORD_SIZE> &out) const {
        return posewise_save_identity(tracker_, out.data(), out.size());
    }
    posewise_status restore_identity(const void *record, size_t size) {
        return posewise_restore_identity(tracker_, static_cast<const uint8_t *>(record), size);
    }

    // Whether the head has the shape of that of a record: POSEWISE_LIKENESS_*.
    posewise_status compare_identity(const void *record, size_t size, uint32_t &likeness) const {
        return posewise_compare_identity(tracker_, static_cast<const uint8_t *>(record), size,
                                         &likeness);
    }

    // What a Monitor needs of the last step.
    posewise_status observe(posewise_monitor_observation &out) const {
        return posewise_monitor_observe(tracker_, &out);
    }

    Tracker copy() const {
        Tracker other;
        if (tracker_ == nullptr || !(other.memory_ = allocate(size_))) {
            other.status_ = tracker_ == nullptr ? status_ : POSEWISE_E_MEMORY;
            return other;
        }
        std::memcpy(other.memory_.get(), memory_.get(), size_);
        other.tracker_ = static_cast<posewise_tracker *>(other.memory_.get());
        other.size_ = size_;
        other.status_ = POSEWISE_OK;
        return other;
    }

    // For functions of posewise.h that this class lacks.
    posewise_tracker *get() const { return tracker_; }

private:
    static constexpr std::align_val_t alignment{POSEWISE_ALIGN};

    struct Free {
        void operator()(void *memory) const { ::operator delete(memory, alignment); }
    };
    using Memory = std::unique_ptr<void, Free>;

    static Memory allocate(std::size_t size) {
        return Memory(::operator new(size, alignment, std::nothrow));
    }

    void swap(Tracker &other) noexcept {
        std::swap(memory_, other.memory_);
        std::swap(tracker_, other.tracker_);
        std::swap(size_, other.size_);
        std::swap(status_, other.status_);
    }

    Memory memory_;
    posewise_tracker *tracker_ = nullptr;
    std::size_t size_ = 0;
    posewise_status status_ = POSEWISE_E_NULL;
};

// Steps several trackers on the same frames, so that each follows a face of its own, for less than
// they cost alone. A copy is a second, independent group.
class Group {
public:
    Group() {
        posewise_group *created = nullptr;
        status_ = posewise_group_init(&created, memory_, sizeof memory_);
    }

    // The trackers are those of the steps before, in the same order; out[k] is of trackers[k].
    posewise_status step(posewise_tracker *const *trackers, std::size_t count,
                         const posewise_frame &frame, posewise_result *out) {
        return posewise_group_step(get(), trackers, count, &frame, out);
    }

    template <std::size_t N>
    posewise_status step(const std::array<Tracker, N> &trackers, const posewise_frame &frame,
                         std::array<posewise_result, N> &out) {
        std::array<posewise_tracker *, N> pointers{};
        for (std::size_t k = 0; k < N; k++) {
            pointers[k] = trackers[k].get();
            out[k] = result();
        }
        return step(pointers.data(), N, frame, out.data());
    }

    posewise_status status() const { return status_; }

    // For functions of posewise.h that this class lacks.
    posewise_group *get() { return reinterpret_cast<posewise_group *>(memory_); }

private:
    alignas(POSEWISE_ALIGN) unsigned char memory_[POSEWISE_GROUP_SIZE] = {};
    posewise_status status_ = POSEWISE_OK;
};

// Watches one driver through the results of a tracker; holds its memory itself. A copy is a second,
// independent monitor.
class Monitor {
public:
    explicit Monitor(const posewise_monitor_config &config = monitor_config()) {
        posewise_monitor *created = nullptr;
        status_ = posewise_monitor_init(&created, memory_, sizeof memory_, &config);
    }

    // Whether the settings were valid; if not, status() and message() give the error.
    explicit operator bool() const { return status_ == POSEWISE_OK; }
    posewise_status status() const { return status_; }
    const char *message() const { return posewise_strerror(status_); }

    posewise_status update(const posewise_monitor_observation &seen, std::int64_t timestamp_us) {
        return posewise_monitor_update(get(), &seen, timestamp_us);
    }

    posewise_status state(posewise_monitor_state &out) const {
        return posewise_monitor_read(get(), &out);
    }

    // Takes the unread events, oldest first, and counts those that were overwritten unread.
    posewise_status events(MonitorEvents &out, std::size_t &count, std::size_t &overwritten) {
        return posewise_monitor_events(get(), out.data(), out.size(), &count, &overwritten);
    }

    // Replaces the zones; times in zones begin anew.
    posewise_status set_zones(const posewise_monitor_zone *zones, std::size_t count) {
        return posewise_monitor_set_zones(get(), zones, count);
    }

    // Another person drives.
    posewise_status forget_driver() { return posewise_monitor_forget_driver(get()); }

    // What was learnt of the driver, for the next drive.
    posewise_status save(std::array<uint8_t, POSEWISE_MONITOR_RECORD_SIZE> &out) const {
        return posewise_monitor_save(get(), out.data(), out.size());
    }
    posewise_status restore(const void *record, size_t size) {
        return posewise_monitor_restore(get(), static_cast<const uint8_t *>(record), size);
    }

    // For functions of posewise.h that this class lacks.
    posewise_monitor *get() { return reinterpret_cast<posewise_monitor *>(memory_); }
    const posewise_monitor *get() const {
        return reinterpret_cast<const posewise_monitor *>(memory_);
    }

private:
    alignas(POSEWISE_ALIGN) unsigned char memory_[POSEWISE_MONITOR_SIZE] = {};
    posewise_status status_ = POSEWISE_OK;
};

} // namespace posewise

#endif
