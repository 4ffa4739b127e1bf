#pragma once
// Encodes pictures to an mp4 file (and PNG files) in a thread of its own, so that the
// next picture is rendered meanwhile.

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "mjdiag/render/image.h"

namespace mjdiag {

class ClipWriter {
 public:
  /// @param frames  folder for PNGs; empty: none
  /// InputError if the file or folder cannot be written or no encoder opens.
  ClipWriter(const std::filesystem::path& file, int width, int height, double fps,
             const std::filesystem::path& frames);
  /// Without Finish, everything written so far is removed.
  ~ClipWriter();
  ClipWriter(const ClipWriter&) = delete;
  ClipWriter& operator=(const ClipWriter&) = delete;

  /// Queues a picture and takes its memory; `picture` gets that of one already encoded.
  /// Waits while the queue is full. Rethrows what went wrong in the thread.
  void Write(Image& picture);
  /// Encodes what is queued and puts the files in place.
  void Finish();

  const std::string& codec() const;

 private:
  class Output;

  void Run();
  void Join();

  std::unique_ptr<Output> output_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Image> queue_;
  std::vector<Image> spare_;
  std::exception_ptr failure_;
  bool closing_ = false;
  std::thread thread_;
};

}  // namespace mjdiag
