#include "mjdiag/studies/svm_classifier.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/ml.hpp>
#include <random>
#include <string>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using MatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kFeatureRounding = 1e-12;  // of a feature's size: less is constant
constexpr double kFarAway = 1e6;  // standardised: keeps distances finite as floats
constexpr int kMostIterations = 20000;  // per machine: bounds the time at a large C
constexpr double kTolerance = 1e-3;     // on the optimality conditions, as in LIBSVM

struct Standardizer {
  std::vector<Index> kept;
  VectorXd mean;  // of the features kept
  VectorXd sd;

  explicit Standardizer(const MatrixXd& features) {
    const Index rows = features.rows();
    const VectorXd all_means = features.colwise().mean();
    const VectorXd all_sds =
        ((features.rowwise() - all_means.transpose()).colwise().norm() /
         std::sqrt(static_cast<double>(rows)))
            .transpose();
    for (Index j = 0; j < features.cols(); ++j) {
      const double size = features.col(j).cwiseAbs().maxCoeff();
      if (all_sds[j] > kFeatureRounding * size) kept.push_back(j);
    }
    mean = all_means(kept);
    sd = all_sds(kept);
  }

  // One vector a row, as OpenCV wants it.
  cv::Mat Apply(const MatrixXd& features) const {
    const auto columns = static_cast<Index>(kept.size());
    cv::Mat standardized(static_cast<int>(features.rows()), static_cast<int>(columns),
                         CV_32F);
    Eigen::Map<MatrixXf> values(standardized.ptr<float>(), features.rows(), columns);
    for (Index j = 0; j < columns; ++j) {
      values.col(j) = ((features.col(kept[j]).array() - mean[j]) / sd[j])
                          .max(-kFarAway)
                          .min(kFarAway)
                          .cast<float>();
    }
    return standardized;
  }
};

// Labels as indices into the list of classes.
std::vector<int> ClassIndices(const std::vector<int>& classes,
                              const std::vector<int>& labels) {
  std::vector<int> indices(labels.size());
  std::transform(labels.begin(), labels.end(), indices.begin(), [&](int label) {
    return static_cast<int>(std::lower_bound(classes.begin(), classes.end(), label) -
                            classes.begin());
  });
  return indices;
}

std::vector<int> SortedUnique(std::vector<int> labels) {
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  return labels;
}

cv::Ptr<cv::ml::SVM> TrainMachine(const cv::Mat& vectors,
                                  const std::vector<int>& classes, double c,
                                  double kernel_gamma) {
  const cv::Ptr<cv::ml::SVM> machine = cv::ml::SVM::create();
  machine->setType(cv::ml::SVM::C_SVC);
  machine->setKernel(cv::ml::SVM::RBF);
  machine->setC(c);
  machine->setGamma(kernel_gamma);
  machine->setTermCriteria({cv::TermCriteria::MAX_ITER | cv::TermCriteria::EPS,
                            kMostIterations, kTolerance});
  const cv::Mat responses(classes, true);
  machine->train(vectors, cv::ml::ROW_SAMPLE, responses);
  return machine;
}

std::vector<int> PredictClasses(const cv::ml::SVM& machine, const cv::Mat& vectors) {
  cv::Mat results;
  machine.predict(vectors, results);
  std::vector<int> classes(static_cast<std::size_t>(vectors.rows));
  for (int k = 0; k < vectors.rows; ++k) {
    classes[k] = static_cast<int>(std::lround(results.at<float>(k)));
  }
  return classes;
}

// The fold of every vector. Each class is shuffled and dealt out in turn, so that a
// fold holds its share of every class, and no fold all vectors of one.
std::vector<int> DrawFolds(const std::vector<int>& classes, int folds,
                           std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<int> fold(classes.size());
  int next = 0;
  const int count = *std::max_element(classes.begin(), classes.end()) + 1;
  for (int label = 0; label < count; ++label) {
    std::vector<std::size_t> members;
    for (std::size_t k = 0; k < classes.size(); ++k) {
      if (classes[k] == label) members.push_back(k);
    }
    for (std::size_t k = members.size(); k > 1; --k) {
      std::swap(members[k - 1], members[random() % k]);
    }
    for (const std::size_t member : members) {
      fold[member] = next;
      next = (next + 1) % folds;
    }
  }
  return fold;
}

// What one fold of the cross-validation trains with and is asked.
struct Fold {
  cv::Mat training;
  std::vector<int> training_classes;
  cv::Mat held_out;
  std::vector<int> held_out_classes;
};

std::vector<Fold> MakeFolds(const MatrixXd& features, const std::vector<int>& classes,
                            const SvmOptions& options) {
  const std::vector<int> fold_of = DrawFolds(classes, options.folds, options.seed);
  std::vector<Fold> folds(static_cast<std::size_t>(options.folds));
  for (int number = 0; number < options.folds; ++number) {
    Fold& fold = folds[number];
    std::vector<Index> training;
    std::vector<Index> held_out;
    for (std::size_t k = 0; k < classes.size(); ++k) {
      const bool out = fold_of[k] == number;
      (out ? held_out : training).push_back(static_cast<Index>(k));
      (out ? fold.held_out_classes : fold.training_classes).push_back(classes[k]);
    }
    const MatrixXd training_rows = features(training, Eigen::all);
    const Standardizer standardizer(training_rows);
    fold.training = standardizer.Apply(training_rows);
    fold.held_out = standardizer.Apply(features(held_out, Eigen::all));
  }
  return folds;
}

// Held-out vectors predicted right, over all folds.
int CountCorrect(const std::vector<Fold>& folds, double c, double kernel_gamma) {
  int correct = 0;
  for (const Fold& fold : folds) {
    // No feature varies in this training part: nothing to tell classes apart by.
    if (fold.training.cols == 0) continue;
    const auto machine =
        TrainMachine(fold.training, fold.training_classes, c, kernel_gamma);
    const std::vector<int> predicted = PredictClasses(*machine, fold.held_out);
    correct += std::transform_reduce(predicted.begin(), predicted.end(),
                                     fold.held_out_classes.begin(), 0, std::plus<>(),
                                     std::equal_to<>());
  }
  return correct;
}

struct GridPoint {
  double c = 0.0;
  double gamma = 0.0;
  int correct = -1;
};

GridPoint SearchGrid(const std::vector<Fold>& folds, Index features_kept,
                     const SvmOptions& options) {
  std::vector<double> cs = options.c;
  std::vector<double> gammas = options.gamma;
  std::sort(cs.begin(), cs.end());
  std::sort(gammas.begin(), gammas.end());
  GridPoint best;
  for (const double gamma : gammas) {
    for (const double c : cs) {
      const int correct =
          CountCorrect(folds, c, gamma / static_cast<double>(features_kept));
      if (correct > best.correct) best = {c, gamma, correct};
    }
  }
  return best;
}

void RequireGrid(const std::vector<double>& values, const std::string& name) {
  if (values.empty()) throw InputError("SVM", "no value of " + name, "at least one");
  for (const double value : values) {
    if (value > 0.0 && std::isfinite(value)) continue;
    throw InputError("SVM", name + " = " + std::to_string(value), "a positive number");
  }
}

void RequireFiniteFeatures(const MatrixXd& features) {
  for (Index i = 0; i < features.rows(); ++i) {
    for (Index j = 0; j < features.cols(); ++j) {
      if (std::isfinite(features(i, j))) continue;
      throw InputError("SVM",
                       "feature " + std::to_string(j) + " of vector " +
                           std::to_string(i) + " is " + std::to_string(features(i, j)),
                       "finite features");
    }
  }
}

void RequireClasses(const std::vector<int>& labels, const std::vector<int>& classes) {
  if (classes.size() < 2) {
    throw InputError("SVM", "a training set of one class only", "at least two classes");
  }
  for (const int label : classes) {
    if (std::count(labels.begin(), labels.end(), label) >= 2) continue;
    throw InputError("SVM", "one vector only of class " + std::to_string(label),
                     "at least two of every class");
  }
}

void RequireTrainingSet(const MatrixXd& features, const std::vector<int>& labels,
                        const std::vector<int>& classes, const SvmOptions& options) {
  if (features.rows() != static_cast<Index>(labels.size())) {
    throw InputError("SVM",
                     std::to_string(features.rows()) + " vectors with " +
                         std::to_string(labels.size()) + " labels",
                     "a label for every vector");
  }
  if (features.size() == 0) {
    throw InputError("SVM", "an empty training set", "some vectors with features");
  }
  RequireClasses(labels, classes);
  RequireFiniteFeatures(features);
  RequireGrid(options.c, "C");
  RequireGrid(options.gamma, "gamma");
  if (options.folds < 2 || options.folds > features.rows()) {
    throw InputError("SVM", std::to_string(options.folds) + " folds",
                     "2 to the number of vectors, " + std::to_string(features.rows()));
  }
}

double Part(int count, int total) {
  return total > 0 ? static_cast<double>(count) / total
                   : std::numeric_limits<double>::quiet_NaN();
}

// Of the vectors of one class: those predicted as that class, and all.
struct ClassCounts {
  int correct = 0;
  int total = 0;
  int predicted = 0;  // as that class, of all vectors
};

ClassCounts CountsOf(const Confusion& confusion, int label) {
  const auto found = std::find(confusion.labels.begin(), confusion.labels.end(), label);
  if (found == confusion.labels.end()) return {};
  const Index k = found - confusion.labels.begin();
  return {confusion.counts(k, k), confusion.counts.row(k).sum(),
          confusion.counts.col(k).sum()};
}

}  // namespace

struct SvmClassifier::Model {
  std::vector<int> labels;
  Index features = 0;
  Standardizer standardizer;
  GridPoint chosen;
  double validation_accuracy = 0.0;
  cv::Ptr<cv::ml::SVM> machine;

  cv::Mat Standardize(const MatrixXd& rows) const {
    if (rows.cols() != features) {
      throw InputError("SVM",
                       "a vector of " + std::to_string(rows.cols()) + " features",
                       std::to_string(features) + " as in training");
    }
    RequireFiniteFeatures(rows);
    return standardizer.Apply(rows);
  }
};

SvmClassifier::SvmClassifier(std::shared_ptr<const Model> model)
    : model_(std::move(model)) {}

SvmClassifier SvmClassifier::Train(const MatrixXd& features,
                                   const std::vector<int>& labels,
                                   const SvmOptions& options) {
  const std::vector<int> classes = SortedUnique(labels);
  RequireTrainingSet(features, labels, classes, options);
  const std::vector<int> indices = ClassIndices(classes, labels);
  const Standardizer standardizer(features);
  const auto kept = static_cast<Index>(standardizer.kept.size());
  if (kept == 0) {
    throw InputError("SVM", "every feature is constant over the training set",
                     "features that vary");
  }
  const GridPoint chosen =
      SearchGrid(MakeFolds(features, indices, options), kept, options);
  const auto machine = TrainMachine(standardizer.Apply(features), indices, chosen.c,
                                    chosen.gamma / static_cast<double>(kept));
  return SvmClassifier(std::make_shared<const Model>(
      Model{classes, features.cols(), standardizer, chosen,
            static_cast<double>(chosen.correct) / static_cast<double>(labels.size()),
            machine}));
}

std::vector<int> SvmClassifier::PredictRows(const MatrixXd& features) const {
  if (features.rows() == 0) return {};
  std::vector<int> labels =
      PredictClasses(*model_->machine, model_->Standardize(features));
  for (int& label : labels) label = model_->labels[label];
  return labels;
}

int SvmClassifier::Predict(const VectorXd& features) const {
  return PredictRows(features.transpose()).front();
}

double SvmClassifier::DecisionValue(const VectorXd& features) const {
  if (model_->labels.size() != 2) {
    throw InputError(
        "SVM",
        "a decision value of " + std::to_string(model_->labels.size()) + " classes",
        "a machine of two classes");
  }
  cv::Mat result;
  model_->machine->predict(model_->Standardize(features.transpose()), result,
                           cv::ml::StatModel::RAW_OUTPUT);
  return -static_cast<double>(result.at<float>(0));  // OpenCV: positive for the first
}

const std::vector<int>& SvmClassifier::labels() const { return model_->labels; }
double SvmClassifier::c() const { return model_->chosen.c; }
double SvmClassifier::gamma() const { return model_->chosen.gamma; }
Index SvmClassifier::features_kept() const {
  return static_cast<Index>(model_->standardizer.kept.size());
}
double SvmClassifier::validation_accuracy() const {
  return model_->validation_accuracy;
}

double Confusion::accuracy() const { return Part(counts.trace(), counts.sum()); }

double Confusion::false_alarm_rate(int healthy) const {
  const ClassCounts of_class = CountsOf(*this, healthy);
  return Part(of_class.total - of_class.correct, of_class.total);
}

double Confusion::missed_detection_rate(int healthy) const {
  const ClassCounts of_class = CountsOf(*this, healthy);
  return Part(of_class.predicted - of_class.correct, counts.sum() - of_class.total);
}

Confusion CountConfusion(const std::vector<int>& actual,
                         const std::vector<int>& predicted) {
  if (actual.empty() || actual.size() != predicted.size()) {
    throw InputError("confusion",
                     std::to_string(actual.size()) + " actual and " +
                         std::to_string(predicted.size()) + " predicted labels",
                     "equally many, at least one");
  }
  std::vector<int> both = actual;
  both.insert(both.end(), predicted.begin(), predicted.end());
  Confusion confusion{SortedUnique(std::move(both)), {}};
  const auto size = static_cast<Index>(confusion.labels.size());
  confusion.counts = Eigen::MatrixXi::Zero(size, size);
  const std::vector<int> rows = ClassIndices(confusion.labels, actual);
  const std::vector<int> columns = ClassIndices(confusion.labels, predicted);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ++confusion.counts(rows[k], columns[k]);
  }
  return confusion;
}

}  // namespace mjdiag
