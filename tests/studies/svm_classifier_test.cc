#include "mjdiag/studies/svm_classifier.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <random>
#include <string>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::MessageOf;

struct Data {
  MatrixXd features;
  std::vector<int> labels;
};

/// Gaussian clouds of sd 1 around random centres of sd `distance` per feature.
Data Clouds(const std::vector<int>& classes, Index per_class, Index features,
            double distance, std::uint64_t seed) {
  std::mt19937_64 centre_random(99);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gaussian;
  Data data{MatrixXd(std::ssize(classes) * per_class, features), {}};
  for (const int label : classes) {
    const VectorXd centre = VectorXd::NullaryExpr(
        features, [&](Index) { return distance * gaussian(centre_random); });
    for (Index k = 0; k < per_class; ++k) {
      const Index row = std::ssize(data.labels);
      for (Index j = 0; j < features; ++j) {
        data.features(row, j) = centre[j] + gaussian(random);
      }
      data.labels.push_back(label);
    }
  }
  return data;
}

/// Points of a square; opposite quadrants are one class.
Data Quadrants(Index count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Data data{MatrixXd(count, 2), {}};
  for (Index k = 0; k < count; ++k) {
    data.features(k, 0) = uniform(random);
    data.features(k, 1) = uniform(random);
    data.labels.push_back(data.features(k, 0) * data.features(k, 1) > 0.0 ? 1 : 0);
  }
  return data;
}

/// A small grid, for what does not depend on a large one.
SvmOptions SmallGrid() { return {.c = {1.0, 16.0, 256.0}, .gamma = {0.25, 1.0, 4.0}}; }

double AccuracyOn(const SvmClassifier& machine, const Data& data) {
  return CountConfusion(data.labels, machine.PredictRows(data.features)).accuracy();
}

TEST(SvmClassifier, LearnsSeparableClasses) {
  const std::vector<int> classes = {7, -1, 300};
  const Data training = Clouds(classes, 30, 8, 5.0, 1);
  const SvmClassifier machine =
      SvmClassifier::Train(training.features, training.labels);
  EXPECT_EQ(machine.labels(), (std::vector<int>{-1, 7, 300}));
  EXPECT_EQ(machine.validation_accuracy(), 1.0);
  const Data fresh = Clouds(classes, 100, 8, 5.0, 2);
  EXPECT_EQ(AccuracyOn(machine, fresh), 1.0);
  EXPECT_EQ(machine.Predict(fresh.features.row(150).transpose()), -1);
}

TEST(SvmClassifier, SeparatesWhatNoPlaneSeparates) {
  // No straight line gets more than three of the four quadrants right.
  const Data training = Quadrants(400, 1);
  const SvmClassifier machine =
      SvmClassifier::Train(training.features, training.labels, SmallGrid());
  EXPECT_GT(AccuracyOn(machine, Quadrants(1000, 2)), 0.95);
}

TEST(SvmClassifier, FindsNothingInPermutedLabels) {
  // Fresh labels are drawn independently of the features, so that whatever the machine
  // answers is right with probability 1/2: within 4 sd of Binomial(1000, 1/2).
  Data training = Quadrants(200, 3);
  std::mt19937_64 random(4);
  std::shuffle(training.labels.begin(), training.labels.end(), random);
  const SvmClassifier machine =
      SvmClassifier::Train(training.features, training.labels, SmallGrid());
  Data fresh = Quadrants(1000, 5);
  std::bernoulli_distribution coin(0.5);
  for (int& label : fresh.labels) label = coin(random) ? 1 : 0;
  EXPECT_NEAR(AccuracyOn(machine, fresh), 0.5, 4.0 * std::sqrt(0.25 / 1000.0));
}

TEST(SvmClassifier, ValidatesOnVectorsThatItDidNotTrainOn) {
  // Few vectors with many features that say nothing: a machine that is tested on its
  // own training set gets all right. The best of 42 grid points, each at most
  // Binomial(100, 1/2), stays below 1/2 + 5 sd = 0.75.
  Data noise = Clouds({0}, 100, 200, 0.0, 6);
  for (std::size_t k = 0; k < noise.labels.size(); ++k) {
    noise.labels[k] = static_cast<int>(k % 2);
  }
  const SvmClassifier machine = SvmClassifier::Train(noise.features, noise.labels);
  EXPECT_LT(machine.validation_accuracy(), 0.75);
  EXPECT_GT(machine.validation_accuracy(), 0.25);
}

TEST(SvmClassifier, ChoosesFromTheGridByValidation) {
  const Data training = Quadrants(400, 1);
  // With a flat kernel and little weight on errors the machine knows no quadrants.
  const SvmClassifier poor = SvmClassifier::Train(training.features, training.labels,
                                                  {.c = {1e-3}, .gamma = {1e-4}});
  EXPECT_LT(poor.validation_accuracy(), 0.7);
  const SvmClassifier chosen = SvmClassifier::Train(
      training.features, training.labels, {.c = {100.0, 1e-3}, .gamma = {4.0, 1e-4}});
  EXPECT_EQ(chosen.c(), 100.0);
  EXPECT_EQ(chosen.gamma(), 4.0);
  EXPECT_GT(chosen.validation_accuracy(), 0.95);
}

TEST(SvmClassifier, ChoosesTheSmoothestOfEquals) {
  const Data training = Clouds({0, 1}, 20, 4, 20.0, 1);
  const SvmClassifier machine =
      SvmClassifier::Train(training.features, training.labels,
                           {.c = {8.0, 2.0, 4.0}, .gamma = {1.0, 0.5, 2.0}});
  EXPECT_EQ(machine.validation_accuracy(), 1.0);
  EXPECT_EQ(machine.c(), 2.0);
  EXPECT_EQ(machine.gamma(), 0.5);
}

void ExpectSameBits(const SvmClassifier& a, const SvmClassifier& b,
                    const MatrixXd& rows) {
  EXPECT_EQ(a.c(), b.c());
  EXPECT_EQ(a.gamma(), b.gamma());
  EXPECT_EQ(a.validation_accuracy(), b.validation_accuracy());
  for (Index k = 0; k < rows.rows(); ++k) {
    const VectorXd row = rows.row(k).transpose();
    EXPECT_EQ(a.DecisionValue(row), b.DecisionValue(row)) << k;
  }
}

TEST(SvmClassifier, TrainsTheSameBitsAgain) {
  const Data training = Clouds({0, 1}, 60, 10, 0.5, 1);
  const auto train = [&] {
    return SvmClassifier::Train(training.features, training.labels, SmallGrid());
  };
  const SvmClassifier first = train();
  auto beside = std::async(std::launch::async, train);
  ExpectSameBits(first, train(), training.features);
  ExpectSameBits(first, beside.get(), training.features);
}

TEST(SvmClassifier, TakesOutTheUnit) {
  // A power of two scales without rounding.
  const Data data = Clouds({0, 1}, 60, 10, 0.5, 1);
  MatrixXd scaled = data.features;
  scaled.col(3) *= std::ldexp(1.0, 40);
  const SvmClassifier plain =
      SvmClassifier::Train(data.features, data.labels, SmallGrid());
  const SvmClassifier other = SvmClassifier::Train(scaled, data.labels, SmallGrid());
  for (Index k = 0; k < scaled.rows(); ++k) {
    EXPECT_EQ(plain.DecisionValue(data.features.row(k).transpose()),
              other.DecisionValue(scaled.row(k).transpose()));
  }
}

TEST(SvmClassifier, LeavesOutConstantFeatures) {
  const Data data = Clouds({0, 1}, 60, 10, 0.5, 1);
  MatrixXd more(data.features.rows(), 12);
  more << MatrixXd::Constant(more.rows(), 1, 0.1), data.features,
      MatrixXd::Zero(more.rows(), 1);
  const SvmClassifier plain =
      SvmClassifier::Train(data.features, data.labels, SmallGrid());
  const SvmClassifier other = SvmClassifier::Train(more, data.labels, SmallGrid());
  EXPECT_EQ(plain.features_kept(), 10);
  EXPECT_EQ(other.features_kept(), 10);
  more.col(0).setConstant(1e30);  // constant in training: it knows nothing of it
  for (Index k = 0; k < more.rows(); ++k) {
    EXPECT_EQ(plain.DecisionValue(data.features.row(k).transpose()),
              other.DecisionValue(more.row(k).transpose()));
  }
}

TEST(SvmClassifier, DecidesByTheSignOfTheDecisionValue) {
  const Data data = Clouds({4, 9}, 60, 10, 0.3, 1);
  const SvmClassifier machine =
      SvmClassifier::Train(data.features, data.labels, SmallGrid());
  for (Index k = 0; k < data.features.rows(); ++k) {
    const VectorXd row = data.features.row(k).transpose();
    EXPECT_EQ(machine.Predict(row), machine.DecisionValue(row) > 0.0 ? 9 : 4);
  }
}

TEST(SvmClassifier, AnswersFarFromTheTrainingSet) {
  const Data data = Clouds({0, 1}, 20, 3, 5.0, 1);
  const SvmClassifier machine = SvmClassifier::Train(data.features, data.labels);
  for (const double far : {1e30, -1e300}) {
    EXPECT_TRUE(std::isfinite(machine.DecisionValue(VectorXd::Constant(3, far))));
  }
}

TEST(SvmClassifier, TrainsOnTwoVectorsAClass) {
  // Every fold must leave one vector of each class to train on, whatever the order.
  MatrixXd features(4, 1);
  features << 0.0, 0.1, 5.0, 5.1;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const SvmClassifier machine =
        SvmClassifier::Train(features, {0, 0, 1, 1}, {.folds = 2, .seed = seed});
    EXPECT_EQ(machine.PredictRows(features), (std::vector<int>{0, 0, 1, 1}));
    EXPECT_EQ(machine.validation_accuracy(), 1.0) << "seed " << seed;
  }
  // Without the odd vector out, nothing varies in its fold's training part.
  MatrixXd odd = MatrixXd::Zero(4, 1);
  odd(3, 0) = 1.0;
  EXPECT_NO_THROW(SvmClassifier::Train(odd, {0, 0, 1, 1}, {.folds = 4}));
}

TEST(SvmClassifier, SaysWhatIsWrongWithTheTrainingSet) {
  MatrixXd good(4, 2);
  good << 0, 1, 2, 3, 4, 5, 6, 7;
  const std::vector<int> labels = {0, 0, 1, 1};
  const auto message = [](const MatrixXd& features, const std::vector<int>& of,
                          const SvmOptions& options = {.folds = 2}) {
    return MessageOf<InputError>([&] { SvmClassifier::Train(features, of, options); });
  };
  EXPECT_EQ(message(MatrixXd(0, 2), {}),
            "SVM: an empty training set; expected some vectors with features");
  EXPECT_EQ(message(MatrixXd(4, 0), labels),
            "SVM: an empty training set; expected some vectors with features");
  EXPECT_EQ(message(good, {0, 1, 0}),
            "SVM: 4 vectors with 3 labels; expected a label for every vector");
  EXPECT_EQ(message(good, {5, 5, 5, 5}),
            "SVM: a training set of one class only; expected at least two classes");
  EXPECT_EQ(message(good, {5, 5, 5, 6}),
            "SVM: one vector only of class 6; expected at least two of every class");
  MatrixXd bad = good;
  bad(2, 1) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(message(bad, labels),
            "SVM: feature 1 of vector 2 is inf; expected finite features");
  EXPECT_EQ(message(MatrixXd::Constant(4, 2, 0.1), labels),
            "SVM: every feature is constant over the training set; expected features "
            "that vary");
  EXPECT_EQ(message(good, labels, {.c = {}}),
            "SVM: no value of C; expected at least one");
  EXPECT_EQ(message(good, labels, {.c = {1.0, 0.0}}),
            "SVM: C = 0.000000; expected a positive number");
  EXPECT_EQ(message(good, labels, {.gamma = {-1.0}}),
            "SVM: gamma = -1.000000; expected a positive number");
  const std::string folds = " folds; expected 2 to the number of vectors, 4";
  EXPECT_EQ(message(good, labels, {.folds = 5}), "SVM: 5" + folds);
  EXPECT_EQ(message(good, labels, {.folds = 1}), "SVM: 1" + folds);
}

TEST(SvmClassifier, SaysWhatIsWrongWithAVector) {
  const Data data = Clouds({0, 1, 2}, 5, 2, 5.0, 1);
  const SvmClassifier machine = SvmClassifier::Train(data.features, data.labels);
  EXPECT_EQ(MessageOf<InputError>([&] { machine.Predict(VectorXd::Zero(3)); }),
            "SVM: a vector of 3 features; expected 2 as in training");
  EXPECT_EQ(MessageOf<InputError>(
                [&] { machine.Predict(VectorXd::Constant(2, std::nan(""))); }),
            "SVM: feature 0 of vector 0 is nan; expected finite features");
  EXPECT_EQ(MessageOf<InputError>([&] { machine.DecisionValue(VectorXd::Zero(2)); }),
            "SVM: a decision value of 3 classes; expected a machine of two classes");
  EXPECT_TRUE(machine.PredictRows(MatrixXd(0, 2)).empty());
}

TEST(Confusion, CountsByClass) {
  // 4 healthy (0), of which 1 taken for a 2; 3 of fault 1, of which 1 missed and 1
  // taken for a 2; 1 of fault 2, found.
  const Confusion confusion =
      CountConfusion({0, 0, 0, 0, 1, 1, 1, 2}, {0, 0, 0, 2, 0, 1, 2, 2});
  EXPECT_EQ(confusion.labels, (std::vector<int>{0, 1, 2}));
  Eigen::Matrix3i counts;
  counts << 3, 0, 1, 1, 1, 1, 0, 0, 1;
  EXPECT_EQ(confusion.counts, Eigen::MatrixXi(counts));
  EXPECT_DOUBLE_EQ(confusion.accuracy(), 5.0 / 8.0);
  EXPECT_DOUBLE_EQ(confusion.false_alarm_rate(0), 1.0 / 4.0);
  EXPECT_DOUBLE_EQ(confusion.missed_detection_rate(0), 1.0 / 4.0);
}

TEST(Confusion, HasNoRateOfWhatDidNotOccur) {
  const Confusion all_faulty = CountConfusion({1, 2}, {1, 0});
  EXPECT_TRUE(std::isnan(all_faulty.false_alarm_rate(0)));
  EXPECT_DOUBLE_EQ(all_faulty.missed_detection_rate(0), 0.5);
  EXPECT_TRUE(std::isnan(CountConfusion({0, 0}, {0, 1}).missed_detection_rate(0)));
}

TEST(Confusion, RefusesUnequalLists) {
  EXPECT_EQ(MessageOf<InputError>([] {
              CountConfusion({1, 2}, {1});
            }),
            "confusion: 2 actual and 1 predicted labels; expected equally many, at "
            "least one");
  EXPECT_THROW(CountConfusion({}, {}), InputError);
}

}  // namespace
}  // namespace mjdiag
