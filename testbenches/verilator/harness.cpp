// Runs a Verilated unit beside the golden model and compares, cycle by cycle, as the golden
// values stream in on standard input: nothing of a run is kept but the last few cycles.
//
// "design.h" is generated for each design. It says where in a record each word stands, drives the
// input ports, and compares. A record is one cycle: the words for the input ports and the golden
// words, each little-endian, in as many bytes as Verilator gives a signal of its width.
//
//   harness HEIGHTS [--vcd FILE FIRST LAST | --preload] < records
//
// HEIGHTS holds the contents of the height memory, 16 bits a word ("-": the unit has none). The
// outcome is one JSON object on standard output. Exit code 0: the run ended, agreeing or not.
// With --preload all records are read before the clock starts: for measuring the model alone.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "design.h"
#include "verilated.h"
#if VM_TRACE
#include "verilated_vcd_c.h"
#endif

namespace {

// Time units of a clock period; the rising edge stands at the cycle's beginning.
constexpr uint64_t kPeriod = 10;
// After so many cycles with a difference the rest is consequence.
constexpr uint64_t kDivergentCycles = 64;

[[noreturn]] void fail(const std::string& message) {
  std::fprintf(stderr, "harness: %s\n", message.c_str());
  std::exit(2);
}

std::vector<uint16_t> read_heights(const char* path) {
  std::vector<uint16_t> heights;
  if (std::strcmp(path, "-") == 0) return heights;
  std::FILE* file = std::fopen(path, "rb");
  if (file == nullptr) fail(std::string(path) + ": cannot be read");
  uint16_t height;
  while (std::fread(&height, sizeof height, 1, file) == 1) heights.push_back(height);
  std::fclose(file);
  return heights;
}

// The stream of records. Right before a record stand those of the last cycles.
class Records {
 public:
  explicit Records(bool preload) : buffer_((kHistory + kRecordsABlock) * kRecordBytes) {
    if (!preload) return;
    size_t bytes = kHistory * kRecordBytes;
    for (size_t more = 1; more != 0; bytes += more) {
      if (bytes == buffer_.size()) buffer_.resize(2 * bytes);
      more = std::fread(&buffer_[bytes], 1, buffer_.size() - bytes, stdin);
    }
    filled_ = bytes / kRecordBytes - kHistory;
    if (filled_ != 0) fill_history();
  }

  // The next record, or nullptr at the end of the stream.
  const unsigned char* next() {
    if (position_ == filled_ && !read_block()) return nullptr;
    return &buffer_[(kHistory + position_++) * kRecordBytes];
  }

 private:
  static constexpr size_t kRecordsABlock = (1 << 16) / kRecordBytes + 1;

  bool read_block() {
    const bool is_first = filled_ == 0;
    std::memmove(buffer_.data(), &buffer_[filled_ * kRecordBytes], kHistory * kRecordBytes);
    unsigned char* const block = &buffer_[kHistory * kRecordBytes];
    const size_t bytes = std::fread(block, 1, kRecordsABlock * kRecordBytes, stdin);
    if (bytes % kRecordBytes != 0) fail("the stream of golden values ends within a record");
    filled_ = bytes / kRecordBytes;
    position_ = 0;
    if (filled_ == 0) return false;
    if (is_first) fill_history();
    return true;
  }

  // What stood in the pipeline before cycle 0 is the idle cycle itself.
  void fill_history() {
    const unsigned char* const first = &buffer_[kHistory * kRecordBytes];
    for (size_t slot = 0; slot < kHistory; ++slot) {
      std::memcpy(&buffer_[slot * kRecordBytes], first, kRecordBytes);
    }
  }

  std::vector<unsigned char> buffer_;
  size_t position_ = 0;
  size_t filled_ = 0;
};

struct Difference {
  size_t probe;
  uint64_t expected;
  uint64_t found;
};

}  // namespace

int main(int argc, char** argv) {
  const bool preload = argc == 3 && std::strcmp(argv[2], "--preload") == 0;
  if (argc != 2 && argc != 6 && !preload) {
    fail("usage: harness HEIGHTS [--vcd FILE FIRST LAST | --preload] < records");
  }
  const std::vector<uint16_t> heights = read_heights(argv[1]);
  if (kHasMemory && heights.size() < kMemoryWords) fail("the height memory's file is too short");

  const auto context = std::make_unique<VerilatedContext>();
  context->randReset(0);
#if VM_TRACE
  context->traceEverOn(true);
#endif
  const auto top = std::make_unique<Top>(context.get());
#if VM_TRACE
  VerilatedVcdC trace;
  uint64_t first_traced = UINT64_MAX;
  uint64_t last_traced = 0;
  if (argc == 6) {
    first_traced = std::strtoull(argv[4], nullptr, 10);
    last_traced = std::strtoull(argv[5], nullptr, 10);
    top->trace(&trace, 99);
    trace.open(argv[3]);
  }
#else
  if (argc == 6) fail("built without waveforms");
#endif

  // In reset the pipeline fills with idle operands: its registers then hold what the golden model
  // says, without a reset of their own.
  uint64_t address = 0;
  const auto rising_edge = [&] {
    address = memory_address(*top);
    top->clk_i = 1;
    top->eval();
    if (kHasMemory) drive_height(*top, heights[address]);
  };
  const std::vector<unsigned char> idle(kRecordBytes, 0);
  top->rst_ni = 0;
  for (int cycle = 0; cycle < kResetCycles; ++cycle) {
    drive(*top, idle.data());
    top->clk_i = 0;
    top->eval();
    rising_edge();
  }
  top->rst_ni = 1;

  Records records(preload);
  std::vector<Difference> first;
  uint64_t first_cycle = 0;
  uint64_t cycles = 0;
  uint64_t mismatches = 0;
  uint64_t divergent_cycles = 0;
  uint64_t results = 0;
  const auto start = std::chrono::steady_clock::now();
  while (const unsigned char* record = records.next()) {
#if VM_TRACE
    const bool traced = cycles >= first_traced && cycles <= last_traced;
    // The edge with which the first cycle began.
    if (traced && cycles == first_traced) trace.dump(cycles * kPeriod);
#endif
    drive(*top, record);
    top->clk_i = 0;
    top->eval();
#if VM_TRACE
    if (traced) trace.dump(cycles * kPeriod + kPeriod / 2);
#endif
    if (differs(*top, record)) {
      for (size_t probe = 0; probe < kProbes; ++probe) {
        const uint64_t expected = expected_value(record, probe);
        const uint64_t found = found_value(*top, probe);
        if (expected == found) continue;
        ++mismatches;
        if (divergent_cycles == 0) {
          first_cycle = cycles;
          first.push_back({probe, expected, found});
        }
      }
      ++divergent_cycles;
    }
    results += result_leaves(*top);
    ++cycles;
    rising_edge();
#if VM_TRACE
    if (traced) trace.dump(cycles * kPeriod);
#endif
    if (divergent_cycles >= kDivergentCycles) break;
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
#if VM_TRACE
  if (argc == 6) trace.close();
#endif
  top->final();

  std::printf("{\"seconds\":%.6f,\"cycles\":%llu,\"results\":%llu,\"mismatches\":%llu,\"first_cycle\":%llu,\"first\":[",
              elapsed.count(), static_cast<unsigned long long>(cycles),
              static_cast<unsigned long long>(results),
              static_cast<unsigned long long>(mismatches),
              static_cast<unsigned long long>(first_cycle));
  for (size_t place = 0; place < first.size(); ++place) {
    std::printf("%s{\"probe\":%zu,\"expected\":%llu,\"found\":%llu}", place == 0 ? "" : ",",
                first[place].probe, static_cast<unsigned long long>(first[place].expected),
                static_cast<unsigned long long>(first[place].found));
  }
  std::printf("]}\n");
  return 0;
}
