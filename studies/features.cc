#include "mjdiag/studies/features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"
#include "mjdiag/signals/spectrum.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kRounding = 1e-13;  // of the peak: less than this is no variation
constexpr double kLeastPeak = 1e-30;

constexpr std::array kTimeNames = {
    "mean",     "log_rms",  "log_sd",       "log_peak",         "crest",
    "kurtosis", "skewness", "shape_factor", "log_peak_to_peak", "impulse_factor"};
constexpr std::array kSpectrumNames = {"centroid", "spread", "dominant"};

// A signal divided by its peak, so that no square of it over- or underflows.
struct ScaledSignal {
  VectorXd samples;
  double scale = 1.0;
  double mean = 0.0;  // of samples

  double LogLevel(double level) const {
    return std::log10(std::max(level, kRounding)) + std::log10(scale);
  }
  double LogPower(double power) const {
    return std::log10(std::max(power, kRounding * kRounding)) + 2.0 * std::log10(scale);
  }
};

ScaledSignal Scale(const VectorXd& signal) {
  const double scale = std::max(signal.cwiseAbs().maxCoeff(), kLeastPeak);
  VectorXd samples = signal / scale;
  const double mean = samples.mean();
  return {std::move(samples), scale, mean};
}

double Ratio(double numerator, double denominator) {
  return denominator > 0.0 ? numerator / denominator : 1.0;
}

// In the order of kTimeNames.
VectorXd TimeFeatures(const ScaledSignal& signal) {
  const VectorXd& x = signal.samples;
  const VectorXd deviation = x.array() - signal.mean;
  const double rms = std::sqrt(x.array().square().mean());
  const double sd = std::sqrt(deviation.array().square().mean());
  const double peak = x.cwiseAbs().maxCoeff();
  const double mean_size = x.cwiseAbs().mean();
  double skewness = 0.0;
  double kurtosis = 3.0;
  if (sd > kRounding) {
    skewness = (deviation / sd).array().cube().mean();
    kurtosis = (deviation / sd).array().square().square().mean();
  }
  VectorXd features(static_cast<Index>(kTimeNames.size()));
  features << signal.mean * signal.scale, signal.LogLevel(rms), signal.LogLevel(sd),
      signal.LogLevel(peak), Ratio(peak, rms), kurtosis, skewness,
      Ratio(rms, mean_size), signal.LogLevel(x.maxCoeff() - x.minCoeff()),
      Ratio(peak, mean_size);
  return features;
}

// The last bin of a band, counted from the lowest. Nyquist is bin segment / 2.
Index LastBin(const FeatureOptions& options, int band) {
  return options.segment >> (options.bands - band);
}

VectorXd BandPowers(const ScaledSignal& signal, const Spectrum& spectrum,
                    const FeatureOptions& options) {
  VectorXd powers(options.bands);
  Index first = 0;
  for (int band = 0; band < options.bands; ++band) {
    const Index next = LastBin(options, band) + 1;
    const double density = spectrum.density.segment(first, next - first).sum();
    powers[band] = signal.LogPower(density * spectrum.resolution());
    first = next;
  }
  return powers;
}

// In the order of kSpectrumNames.
VectorXd SpectrumShape(const Spectrum& spectrum) {
  VectorXd shape = VectorXd::Zero(static_cast<Index>(kSpectrumNames.size()));
  const double total = spectrum.density.sum();
  if (!(total * spectrum.resolution() > kRounding * kRounding)) return shape;
  const VectorXd weight = spectrum.density / total;
  const double centroid = weight.dot(spectrum.frequency);
  const auto distance = spectrum.frequency.array() - centroid;
  Index strongest = 0;
  spectrum.density.maxCoeff(&strongest);
  shape << centroid, std::sqrt(weight.dot(distance.square().matrix())),
      spectrum.frequency[strongest];
  return shape;
}

VectorXd SignalFeatures(const VectorXd& samples, double sample_time,
                        const FeatureOptions& options) {
  const ScaledSignal signal = Scale(samples);
  const VectorXd deviation = signal.samples.array() - signal.mean;
  const Spectrum spectrum = WelchDensity(deviation, sample_time, options.segment);
  const VectorXd time = TimeFeatures(signal);
  const VectorXd bands = BandPowers(signal, spectrum, options);
  const VectorXd shape = SpectrumShape(spectrum);
  VectorXd features(time.size() + bands.size() + shape.size());
  features << time, bands, shape;
  return features;
}

// "log_power_15.6-31.2_Hz" and so on, from the lowest band.
std::vector<std::string> BandNames(double sample_time, int bands) {
  const double nyquist = 0.5 / sample_time;
  std::vector<std::string> names(static_cast<std::size_t>(bands), "log_power_");
  std::string edge = "0";
  for (int band = 0; band < bands; ++band) {
    names[band] += edge + "-";
    edge = FormatNumber(std::ldexp(nyquist, band + 1 - bands));
    names[band] += edge + "_Hz";
  }
  return names;
}

// The same order as SignalFeatures.
std::vector<std::string> SignalFeatureNames(const std::string& signal,
                                            double sample_time,
                                            const FeatureOptions& options) {
  std::vector<std::string> names(kTimeNames.begin(), kTimeNames.end());
  const std::vector<std::string> bands = BandNames(sample_time, options.bands);
  names.insert(names.end(), bands.begin(), bands.end());
  names.insert(names.end(), kSpectrumNames.begin(), kSpectrumNames.end());
  for (std::string& name : names) name.insert(0, signal + ".");
  return names;
}

void RequireOptions(const std::vector<std::string>& channels,
                    const FeatureOptions& options) {
  if (channels.empty()) {
    throw InputError("features", "no channels", "the names of some");
  }
  if (options.bands < 1 || options.bands > 62 || LastBin(options, 0) < 1) {
    throw InputError("features",
                     std::to_string(options.bands) + " octave bands of segments of " +
                         std::to_string(options.segment) + " samples",
                     "at least one band, and for n bands at least 2^n samples");
  }
}

void RequireFinite(const Channel& channel, const Record& record) {
  for (Index k = 0; k < channel.samples.size(); ++k) {
    if (std::isfinite(channel.samples[k])) continue;
    throw InputError("features",
                     "channel \"" + channel.name + "\" is " +
                         std::to_string(channel.samples[k]) + " at " +
                         std::to_string(record.start_time() +
                                        static_cast<double>(k) * record.sample_time()) +
                         " s",
                     "finite values");
  }
}

// The reference of a channel whose tracking error is wanted, or null.
const Channel* FindReference(const Record& record, const std::string& channel,
                             const FeatureOptions& options) {
  return options.tracking_errors ? record.Find(channel + "_ref") : nullptr;
}

}  // namespace

VectorXd Features(const Record& record, const std::vector<std::string>& channels,
                  const FeatureOptions& options) {
  RequireOptions(channels, options);
  std::vector<VectorXd> parts;
  Index size = 0;
  const auto append = [&](const VectorXd& samples) {
    parts.push_back(SignalFeatures(samples, record.sample_time(), options));
    size += parts.back().size();
  };
  for (const std::string& name : channels) {
    const Channel& channel = record.At(name);
    RequireFinite(channel, record);
    append(channel.samples);
    const Channel* reference = FindReference(record, name, options);
    if (reference == nullptr) continue;
    RequireFinite(*reference, record);
    append(reference->samples - channel.samples);
  }
  VectorXd features(size);
  Index first = 0;
  for (const VectorXd& part : parts) {
    features.segment(first, part.size()) = part;
    first += part.size();
  }
  return features;
}

std::vector<std::string> FeatureNames(const Record& record,
                                      const std::vector<std::string>& channels,
                                      const FeatureOptions& options) {
  RequireOptions(channels, options);
  std::vector<std::string> names;
  const auto append = [&](const std::string& signal) {
    for (std::string& name :
         SignalFeatureNames(signal, record.sample_time(), options)) {
      names.push_back(std::move(name));
    }
  };
  for (const std::string& name : channels) {
    append(record.At(name).name);
    if (FindReference(record, name, options) != nullptr) append(name + "_error");
  }
  return names;
}

}  // namespace mjdiag
