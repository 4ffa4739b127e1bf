// filters.json, and some ticks of the diagnosis that it describes.

#include <cmath>
#include <vector>

#include "fuzz/target.h"
#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/diagnosis/filters_file.h"

namespace mjdiag::fuzz {

void FuzzFilters(Input input) {
  const auto file = WriteFile("filters.json", TextOf(input));
  Done([&] {
    const DiagnosisDesign design = ReadFilters(file);
    constexpr int kTicks = 40;
    DiagnosisRecording recording(design, kTicks);
    std::vector<double> outputs(design.outputs.size());
    std::vector<double> inputs(design.inputs.size());
    for (int k = 0; k < kTicks; ++k) {
      std::ranges::fill(outputs, std::sin(0.1 * k));
      std::ranges::fill(inputs, std::cos(0.1 * k));
      recording.Add(outputs, inputs);
    }
    recording.Finish();
    WriteFilters(Folder() / "again.json", design);
    MustDo("filters that were written", [&] { ReadFilters(Folder() / "again.json"); });
  });
}

}  // namespace mjdiag::fuzz
