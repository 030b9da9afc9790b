// wrapper.cpp FRAMES WIDTH HEIGHT - posewise.hpp does what posewise.h says.
#include "check.h"
#include "posewise.hpp"

#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <vector>

int main(int argc, char **argv) {
    if (argc != 4)
        return 2;
    std::ifstream file(argv[1], std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    const auto width = static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10));
    const auto height = static_cast<std::uint32_t>(std::strtoul(argv[3], nullptr, 10));
    const std::size_t len = static_cast<std::size_t>(width) * height;
    const auto *frames = reinterpret_cast<const std::uint8_t *>(bytes.data());

    const posewise::Model model = posewise::Model::built_in();
    CHECK(model.check() == POSEWISE_OK);
    CHECK(posewise::Model{}.check() == POSEWISE_E_NULL);
    posewise_model_details info = posewise::model_details();
    CHECK(model.info(info) == POSEWISE_OK && info.check_len == 0 && info.length == model.size);
    CHECK(!posewise::Tracker(posewise::Model{}));
    posewise_config wrong = posewise::config();
    wrong.min_face_px = 1;
    CHECK(posewise::Tracker(model, wrong).status() == POSEWISE_E_MIN_FACE);

    posewise::Tracker none;
    posewise_result a = posewise::result(), b = posewise::result();
    posewise::Landmarks points;
    posewise::Animation weights;
    CHECK(!none && none.step(posewise::frame(), a) == POSEWISE_E_NULL && !none.copy());
    posewise::Tracker first(model), second;
    CHECK(first);
    posewise::MeshVertices vertices;
    posewise_mesh_topology tables = posewise::mesh_topology();
    std::size_t vertex_count = 0;
    CHECK(first.mesh_tables(tables) == POSEWISE_OK && tables.triangle_count > 0);
    posewise_monitor_config wrong_times = posewise::monitor_config();
    wrong_times.gap_us = 1;
    CHECK(posewise::Monitor(wrong_times).status() == POSEWISE_E_MONITOR_CONFIG);
    posewise::Monitor monitor;
    posewise_monitor_observation seen = posewise::monitor_observation();
    posewise_monitor_state state = posewise::monitor_state();
    CHECK(monitor && none.observe(seen) == POSEWISE_E_NULL);
    for (std::size_t i = 0; (i + 1) * len <= bytes.size(); i++) {
        const auto frame =
            posewise::grey(frames + i * len, width, height, static_cast<std::int64_t>(i) * 33333);
        CHECK(first.step(frame, a) == POSEWISE_OK);
        CHECK(first.landmarks(points) == POSEWISE_OK && first.animation(weights) == POSEWISE_OK);
        CHECK(first.smoothed(b) == POSEWISE_OK && b.state == a.state);
        CHECK(first.smoothed_landmarks(points) == POSEWISE_OK);
        CHECK(first.smoothed_animation(weights) == POSEWISE_OK);
        const posewise_status meshed = first.mesh(POSEWISE_MESH_SPACE_HEAD, vertices, vertex_count);
        CHECK(meshed == (a.state == POSEWISE_SEARCHING ? POSEWISE_E_NO_FACE : POSEWISE_OK));
        CHECK(meshed != POSEWISE_OK || vertex_count == tables.vertex_count);
        const posewise_status shaped =
            first.mesh_shape(POSEWISE_MESH_NEUTRAL, vertices, vertex_count);
        CHECK(shaped == POSEWISE_OK || (shaped == POSEWISE_E_NO_FACE && meshed == shaped));
        CHECK(first.observe(seen) == POSEWISE_OK && seen.state == a.state);
        CHECK(monitor.update(seen, a.timestamp_us) == POSEWISE_OK);
        CHECK(monitor.state(state) == POSEWISE_OK && state.timestamp_us == a.timestamp_us);
        if (second) {
            CHECK(second.step(frame, b) == POSEWISE_OK);
            CHECK(std::memcmp(&a, &b, sizeof a) == 0);
        }
        if (i == 5)
            second = first.copy();
    }
    CHECK(second);
    posewise::Monitor other = monitor;
    posewise_monitor_state same = posewise::monitor_state();
    CHECK(other.state(same) == POSEWISE_OK && std::memcmp(&same, &state, sizeof same) == 0);
    CHECK(monitor.update(seen, state.timestamp_us) == POSEWISE_E_TIME);
    CHECK(monitor.set_zones(nullptr, 0) == POSEWISE_OK && monitor.forget_driver() == POSEWISE_OK);
    posewise::MonitorEvents driver_events;
    std::size_t seen_events, lost_events;
    CHECK(monitor.events(driver_events, seen_events, lost_events) == POSEWISE_OK);
    CHECK(seen_events <= driver_events.size() && lost_events == 0);
    posewise::Group group;
    std::array<posewise::Tracker, 2> members{second.copy(), posewise::Tracker(model)};
    std::array<posewise_result, 2> grouped;
    CHECK(group.status() == POSEWISE_OK);
    const auto next = posewise::grey(frames, width, height, a.timestamp_us + 33333);
    CHECK(group.step(members, next, grouped) == POSEWISE_OK);
    CHECK(grouped[0].timestamp_us == next.timestamp_us && grouped[1].state != POSEWISE_TRACKING);
    CHECK(group.step(members, next, grouped) == POSEWISE_E_TIME);
    posewise::Tracker moved(std::move(first));
    std::array<uint8_t, POSEWISE_IDENTITY_RECORD_SIZE> record;
    uint32_t likeness = POSEWISE_LIKENESS_OTHER;
    if (moved.save_identity(record) == POSEWISE_OK) {
        CHECK(moved.compare_identity(record.data(), record.size(), likeness) == POSEWISE_OK);
        CHECK(likeness != POSEWISE_LIKENESS_OTHER);
        CHECK(moved.restore_identity(record.data(), record.size()) == POSEWISE_OK);
    }
    CHECK(none.save_identity(record) == POSEWISE_E_NULL);
    CHECK(moved && !first && moved.reset() == POSEWISE_OK);
    CHECK(moved.forget_identity() == POSEWISE_OK && none.forget_identity() == POSEWISE_E_NULL);
    posewise::Events events;
    std::size_t count, overwritten;
    CHECK(moved.events(events, count, overwritten) == POSEWISE_OK && overwritten == 0);
    CHECK(count >= 2 && events[count - 1].kind == POSEWISE_EVENT_FORGOTTEN);
    CHECK(moved.set_intrinsics({800, 800, 320, 240}) == POSEWISE_OK);
    CHECK(moved.set_excluded(nullptr, 0) == POSEWISE_OK);
    CHECK(moved.set_lens({POSEWISE_LENS_BROWN, {-0.2f, 0, 0, 0, 0}}) == POSEWISE_OK);
    CHECK(moved.set_roi({0, 0, 10, 10}) == POSEWISE_OK && moved.set_roi({}) == POSEWISE_OK);
    return failures;
}
