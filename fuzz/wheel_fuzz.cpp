#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/live/driver/guided_calibration.hpp"

// What an input device delivers: through the axes to the driver's input, and through a guided calibration that is
// confirmed after every report.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace veridyn::live;
  const WheelCalibration calibration = source_calibration();
  WheelAxes axes(calibration.at_rest());
  GuidedCalibration guided(calibration.at_rest(), 7.854);
  WheelEventDecoder decoder;
  Bytes bytes(data, size);
  while (const std::optional<WheelEvent> event = decoder.next(bytes)) {
    guided.take(*event);
    if (!axes.take(*event)) continue;
    const std::optional<DriverInput> input = calibration.input(axes);
    VERIDYN_ASSERT(input && input->throttle >= 0.0 && input->throttle <= 1.0);
    VERIDYN_ASSERT(input->brake >= 0.0 && input->brake <= 1.0);
    VERIDYN_ASSERT(input->steering >= -7.854 && input->steering <= 7.854);
    (void)guided.confirm();
    if (guided.step() == CalibrationStep::kDone) {
      VERIDYN_ASSERT(!guided.calibration().problem());
      guided.back();
    }
  }
  VERIDYN_ASSERT(decoder.pending() == size % WheelEventDecoder::kRecord);
  return 0;
}
