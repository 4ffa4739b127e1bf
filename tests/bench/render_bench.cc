// What a finished clip costs beside the least that any clip costs: frames a second of
// RenderClip (two amplified views, overlays, diagnosis, rendering beside painting and
// encoding) over those of a bare loop of mjr_render, read back and encode, one after
// the other. Both make 1280x720 clips of the same run with the same encoder and the
// same quality of picture, and both times include opening and closing everything. They
// run in turn, so that whatever else the computer does meets both alike, and each in a
// process of its own, as OSMesa's threads belong to the process. One round is made;
// --benchmark_repetitions makes more, and scripts/bench takes their median.
//
// The encoder and OSMesa have threads of their own, so the bare loop, too, fills more
// than one core. What overlap brings in all shows beside a loop that overlaps nothing:
// first every picture, then the encoding of all. The processor time of a frame, over
// all threads, says what a busy computer sees.

#include <benchmark/benchmark.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/render/clip.h"
#include "mjdiag/render/drawn_joints.h"
#include "mjdiag/render/scene/offscreen_context.h"
#include "support/bonder.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr int kFrames = 240;
constexpr double kFps = 30.0;

/// Elapsed time, and processor time of all threads [s].
struct Seconds {
  double elapsed = 0.0;
  double processor = 0.0;
};

class Stopwatch {
 public:
  Seconds Read() const {
    return {std::chrono::duration<double>(Clock::now() - start_).count(),
            static_cast<double>(std::clock() - processor_start_) / CLOCKS_PER_SEC};
  }

 private:
  Clock::time_point start_ = Clock::now();
  std::clock_t processor_start_ = std::clock();
};

/// The bonder, healthy and worn, and what a diagnosis might have said.
struct Subject {
  Subject() {
    RunOptions options;
    options.log_joints = true;
    const Setup& setup = machine.setup();
    const Excitation excitation =
        FollowTrajectory(setup, setup.trajectories.Find(setup.trajectories.fallback));
    healthy = Simulate(machine, excitation, options).Slice(0, 1600);
    options.seed = 2;
    worn = Simulate(machine, excitation, options).Slice(0, 1600);
    overlay.run = 1;
    overlay.residual = Record(worn.sample_time());
    overlay.residual.Add({"residual", "1", worn.At("x").samples});
    overlay.limit_low = -1e-3;
    overlay.limit_high = 1e-3;
    overlay.detection = 0.05;
    overlay.estimate_time = Eigen::VectorXd::LinSpaced(400, 0.0, 0.2);
    for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h"}) {
      overlay.estimates.push_back({name, 1.0, Eigen::VectorXd::Constant(400, 1.1),
                                   Eigen::VectorXd::Constant(400, 0.05)});
    }
  }
  Machine machine = test::Bonder({"trajectories.multi.duration=0.25"});
  const mjModel& model = machine.plant();
  Record healthy;
  Record worn;
  DiagnosisOverlay overlay;
};

Seconds ClipSeconds(const Subject& subject, bool everything,
                    const std::filesystem::path& file) {
  const std::array runs{ClipRun{"healthy", &subject.healthy},
                        ClipRun{"worn", &subject.worn}};
  ClipOptions options;
  options.picture.camera = "machine";
  if (everything) options.picture.diagnosis = subject.overlay;
  options.fps = kFps;
  const double last = subject.healthy.duration() - subject.healthy.sample_time();
  options.speed = last * kFps / (kFrames - 1);
  const Stopwatch watch;
  const ClipSummary summary = RenderClip(subject.model, runs, options, file);
  const Seconds seconds = watch.Read();
  if (summary.frames != kFrames) throw std::runtime_error("not the frames expected");
  return seconds;
}

// Straight MuJoCo and OpenCV, with no more than makes the clip upright and its colours
// right.
Seconds BareSeconds(const Subject& subject, bool overlap_nothing,
                    const std::filesystem::path& file) {
  const Stopwatch watch;
  const ModelPtr model = CopyModel(subject.model);
  model->vis.global.offwidth = kWidth;
  model->vis.global.offheight = kHeight;
  model->vis.quality.offsamples = 0;
  model->vis.quality.shadowsize = 0;
  const OffscreenContext offscreen;
  mjvScene scene;
  mjv_defaultScene(&scene);
  mjv_makeScene(model.get(), &scene, 2000);
  scene.flags[mjRND_SHADOW] = 0;
  mjrContext context;
  mjr_defaultContext(&context);
  mjr_makeContext(model.get(), &context, mjFONTSCALE_100);
  mjr_setBuffer(mjFB_OFFSCREEN, &context);
  mjvOption visual;
  mjv_defaultOption(&visual);
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.type = mjCAMERA_FIXED;
  camera.fixedcamid = mj_name2id(model.get(), mjOBJ_CAMERA, "machine");
  const DataPtr data = MakeData(*model);
  const std::vector<DrawnJoint> joints = DrawnJoints(*model);
  cv::VideoWriter video(file.string(), cv::CAP_FFMPEG,
                        cv::VideoWriter::fourcc('a', 'v', 'c', '1'), kFps,
                        {kWidth, kHeight});
  if (!video.isOpened()) {
    video.open(file.string(), cv::CAP_FFMPEG,
               cv::VideoWriter::fourcc('m', 'p', '4', 'v'), kFps, {kWidth, kHeight});
  }
  const mjrRect viewport{0, 0, kWidth, kHeight};
  cv::Mat pixels(kHeight, kWidth, CV_8UC3);
  cv::Mat upright;
  std::vector<cv::Mat> pictures(overlap_nothing ? kFrames : 1);
  for (int n = 0; n < kFrames; ++n) {
    const Eigen::Index sample = (subject.worn.samples() - 1) * n / (kFrames - 1);
    Eigen::VectorXd positions(static_cast<Eigen::Index>(joints.size()));
    for (std::size_t j = 0; j < joints.size(); ++j) {
      positions[static_cast<Eigen::Index>(j)] =
          subject.worn.At(JointChannel(joints[j])).samples[sample];
    }
    SetPositions(*model, positions, *data);
    mj_kinematics(model.get(), data.get());
    mj_comPos(model.get(), data.get());
    mj_camlight(model.get(), data.get());
    mjv_updateScene(model.get(), data.get(), &visual, nullptr, &camera, mjCAT_ALL,
                    &scene);
    mjr_render(viewport, &scene, &context);
    mjr_readPixels(pixels.data, nullptr, viewport, &context);
    cv::flip(pixels, upright, 0);
    cv::Mat& picture = pictures[overlap_nothing ? n : 0];
    cv::cvtColor(upright, picture, cv::COLOR_RGB2BGR);
    if (!overlap_nothing) video.write(picture);
  }
  if (overlap_nothing) {
    for (const cv::Mat& picture : pictures) video.write(picture);
  }
  video.release();
  mjr_freeContext(&context);
  mjv_freeScene(&scene);
  return watch.Read();
}

// The loops by name, each run by a process of its own.
constexpr const char* kLoop = "--loop";

int RunLoop(const std::string& name) {
  const Subject subject;
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "clip.mp4";
  Seconds seconds;
  if (name == "bare") seconds = BareSeconds(subject, false, file);
  if (name == "bare_apart") seconds = BareSeconds(subject, true, file);
  if (name == "side_by_side") seconds = ClipSeconds(subject, false, file);
  if (name == "with_diagnosis") seconds = ClipSeconds(subject, true, file);
  std::printf("%.6f %.6f\n", seconds.elapsed, seconds.processor);
  return 0;
}

Seconds InProcess(const std::string& name) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command = "'" + self + "' " + kLoop + " " + name;
  std::FILE* output = popen(command.c_str(), "r");
  Seconds seconds;
  const int read = output == nullptr ? 0
                                     : std::fscanf(output, "%lf %lf", &seconds.elapsed,
                                                   &seconds.processor);
  if (output == nullptr || pclose(output) != 0 || read != 2) {
    throw std::runtime_error("the loop " + name + " did not run");
  }
  return seconds;
}

void ClipOverBareFrames(benchmark::State& state, const std::string& kind,
                        const std::string& bare) {
  for (auto _ : state) {
    const Seconds clip = InProcess(kind);
    const Seconds frames = InProcess(bare);
    state.counters["over_bare"] = frames.elapsed / clip.elapsed;
    state.counters["clip_frames_per_s"] = kFrames / clip.elapsed;
    state.counters["bare_frames_per_s"] = kFrames / frames.elapsed;
    state.counters["clip_cpu_ms"] = 1e3 * clip.processor / kFrames;
    state.counters["bare_cpu_ms"] = 1e3 * frames.processor / kFrames;
  }
}

BENCHMARK_CAPTURE(ClipOverBareFrames, side_by_side, "side_by_side", "bare")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);
BENCHMARK_CAPTURE(ClipOverBareFrames, with_diagnosis, "with_diagnosis", "bare")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);
BENCHMARK_CAPTURE(ClipOverBareFrames, with_diagnosis_over_apart, "with_diagnosis",
                  "bare_apart")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
}  // namespace mjdiag

// What it throws ends it, with its text.
// NOLINTNEXTLINE(bugprone-exception-escape)
int main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[1]) == mjdiag::kLoop) {
    return mjdiag::RunLoop(argv[2]);
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
