// What a finished clip costs beside the least that any clip costs: frames a second of
// RenderClip (two amplified views, overlays, diagnosis, encoder in a thread of its own)
// over those of a bare loop of mjr_render, read back and encode, one after the other.
// Both make 1280x720 clips of the same run with the same encoder, and both times
// include opening and closing everything. They run in turn, so that whatever else the
// computer does meets both alike; the figure is the median of the rounds' ratios.
// OSMesa and the encoder have threads of their own, so the bare loop, too, fills more
// than one core: the processor time of a frame, over all threads, says what a busy
// computer sees.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "mjdiag/plugin/simulation.h"
#include "mjdiag/render/clip.h"
#include "mjdiag/render/drawn_joints.h"
#include "mjdiag/render/offscreen_context.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr int kFrames = 90;
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

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// The bonder, healthy and worn, and what a diagnosis might have said.
struct Subject {
  Subject() {
    RunOptions options;
    options.log_joints = true;
    Excitation excitation =
        FollowTrajectory(setup, setup.FindTrajectory(setup.default_trajectory));
    healthy = Simulate(setup, *model, excitation, options).Slice(0, 1600);
    options.seed = 2;
    worn = Simulate(setup, *model, excitation, options).Slice(0, 1600);
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
  Setup setup = ReadSetup(std::string(MJDIAG_SOURCE_DIR) + "/mjcf/ab383");
  ModelPtr model = LoadPlant(setup);
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
  const ClipSummary summary = RenderClip(*subject.model, runs, options, file);
  const Seconds seconds = watch.Read();
  if (summary.frames != kFrames) throw std::runtime_error("not the frames expected");
  return seconds;
}

// Straight MuJoCo and OpenCV, with no more than makes the clip upright and its colours
// right.
Seconds BareSeconds(const Subject& subject, const std::filesystem::path& file) {
  const Stopwatch watch;
  const ModelPtr model = CopyModel(*subject.model);
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
  cv::Mat bgr;
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
    cv::cvtColor(upright, bgr, cv::COLOR_RGB2BGR);
    video.write(bgr);
  }
  video.release();
  mjr_freeContext(&context);
  mjv_freeScene(&scene);
  return watch.Read();
}

void ClipOverBareFrames(benchmark::State& state, bool everything) {
  const Subject subject;
  const test::TemporaryFolder folder;
  std::vector<double> ratios;
  Seconds clip_sum;
  Seconds bare_sum;
  const auto add = [](const Seconds& seconds, Seconds& sum) {
    sum.elapsed += seconds.elapsed;
    sum.processor += seconds.processor;
  };
  for (auto _ : state) {
    const Seconds clip = ClipSeconds(subject, everything, folder / "clip.mp4");
    const Seconds bare = BareSeconds(subject, folder / "bare.mp4");
    add(clip, clip_sum);
    add(bare, bare_sum);
    ratios.push_back(bare.elapsed / clip.elapsed);
  }
  const double frames = static_cast<double>(kFrames * ratios.size());
  state.counters["clip_over_bare_rate"] = Median(ratios);
  state.counters["clip_frames_per_s"] = frames / clip_sum.elapsed;
  state.counters["bare_frames_per_s"] = frames / bare_sum.elapsed;
  state.counters["clip_cpu_ms_per_frame"] = 1e3 * clip_sum.processor / frames;
  state.counters["bare_cpu_ms_per_frame"] = 1e3 * bare_sum.processor / frames;
}

BENCHMARK_CAPTURE(ClipOverBareFrames, side_by_side, false)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(5);
BENCHMARK_CAPTURE(ClipOverBareFrames, with_diagnosis, true)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(5);

}  // namespace
}  // namespace mjdiag

BENCHMARK_MAIN();
