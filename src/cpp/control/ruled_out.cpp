#include "robotteamsim/control/ruled_out.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/hypot.hpp"

namespace robotteamsim::control {
namespace {

constexpr double kSamePlace = 0.25;
constexpr std::size_t kSmallestTable = 64;  // a power of two, like all sizes

/// Places beyond this many buckets share the last one.
constexpr int kMostBuckets = 1 << 30;

std::uint64_t NextId() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

void Check(const HeardNote& note) {
  base::Check(note.position, "position");
  if (note.loudest) base::Check(*note.loudest, "loudest");
}

}  // namespace

HeardKey::HeardKey(const HeardNote& note)
    : column(std::nearbyint(note.position.x / kSamePlace)),
      row(std::nearbyint(note.position.y / kSamePlace)),
      hears(note.loudest.has_value()),
      loudest(note.loudest.value_or(base::Point{})),
      hash(hears ? 1 : 0) {
  const std::hash<double> hash_of;  // equal for 0.0 and -0.0
  for (const double part : {column, row, loudest.x, loudest.y}) {
    hash = (hash ^ hash_of(part)) * 0x9E3779B97F4A7C15U;
    hash ^= hash >> 32U;
  }
}

bool HeardKey::operator==(const HeardKey& other) const {
  return hash == other.hash && column == other.column && row == other.row && hears == other.hears &&
         loudest.x == other.loudest.x && loudest.y == other.loudest.y;
}

HeardNotes::HeardNotes(std::vector<HeardNote> notes) : notes_(std::move(notes)) {
  for (const HeardNote& note : notes_) {
    Check(note);
    keys_.emplace_back(note);
  }
}

NoteLog::NoteLog(double bucket_m) : id_(NextId()), bucket_m_(bucket_m), table_(kSmallestTable, 0) {}

NoteLog::NoteLog(const NoteLog& other, std::size_t length) : NoteLog(other.bucket_m_) {
  for (std::size_t i = 0; i < length; ++i) Add(other.notes_[i], HeardKey(other.notes_[i]));
}

void NoteLog::Add(const HeardNote& note, const HeardKey& key) {
  const std::size_t place = PlaceOf(key);
  if (table_[place] != 0) return;
  buckets_[BucketOf(note.position.x, note.position.y, 0, 0)].push_back(static_cast<std::uint32_t>(notes_.size()));
  notes_.push_back(note);
  hashes_.push_back(key.hash);
  table_[place] = static_cast<std::uint32_t>(notes_.size());
  if (2 * notes_.size() > table_.size()) Grow();
}

bool NoteLog::Has(const HeardKey& key, std::size_t length) const {
  const std::uint32_t number = table_[PlaceOf(key)];
  return number != 0 && number <= length;
}

std::int64_t NoteLog::BucketOf(double x, double y, int d_column, int d_row) const {
  const std::int64_t column = base::ClampedInt(std::floor(x / bucket_m_), -kMostBuckets, kMostBuckets) + d_column;
  const std::int64_t row = base::ClampedInt(std::floor(y / bucket_m_), -kMostBuckets, kMostBuckets) + d_row;
  return column * (std::int64_t{1} << 32) + row;
}

void NoteLog::Grow() {
  table_.assign(2 * table_.size(), 0);
  for (std::size_t i = 0; i < notes_.size(); ++i) table_[EmptyPlace(hashes_[i])] = static_cast<std::uint32_t>(i + 1);
}

/// Returns the place of a key in the table, or the empty place for it.
std::size_t NoteLog::PlaceOf(const HeardKey& key) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t place = key.hash & mask;
  for (; table_[place] != 0; place = (place + 1) & mask) {
    const std::size_t index = table_[place] - 1;
    if (hashes_[index] == key.hash && HeardKey(notes_[index]) == key) break;
  }
  return place;
}

std::size_t NoteLog::EmptyPlace(std::size_t hash) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t place = hash & mask;
  while (table_[place] != 0) place = (place + 1) & mask;
  return place;
}

RuledOut::RuledOut(double radius_m, double cell_m, double next_to_m)
    : radius_m_(radius_m), cell_m_(cell_m), next_to_m_(next_to_m), bucket_m_(std::max(radius_m, next_to_m)) {
  base::CheckNotNegative(radius_m, "radius_m");
  base::CheckNotNegative(cell_m, "cell");
  base::CheckNotNegative(next_to_m, "next_to_m");
  base::CheckPositive(bucket_m_, "radius_m");
}

void RuledOut::Clear() {
  log_.reset();
  length_ = 0;
  own_.reset();
}

void RuledOut::Add(const HeardNote& note) {
  Check(note);
  const HeardKey key(note);
  AddOwn();
  if (!log_ || !log_->Has(key, length_)) own_.emplace(note, key);
}

void RuledOut::Add(HeardNotes* heard) {
  const auto& keys = heard->keys();
  if (own_ && std::find(keys.begin(), keys.end(), own_->second) == keys.end()) AddOwn();
  own_.reset();
  const auto before = std::make_tuple(log_ ? log_->id() : 0, length_, bucket_m_);
  const auto known = heard->received_.find(before);
  if (known != heard->received_.end()) {
    if (const std::shared_ptr<NoteLog> log = known->second.first.lock()) {
      log_ = log;
      length_ = known->second.second;
      return;
    }
  }
  NoteLog& log = Continued();
  for (std::size_t i = 0; i < keys.size(); ++i) log.Add(heard->notes()[i], keys[i]);
  length_ = log.size();
  heard->received_[before] = {log_, length_};
}

void RuledOut::AddOwn() {
  if (!own_) return;
  NoteLog& log = Continued();
  log.Add(own_->first, own_->second);
  length_ = log.size();
  own_.reset();
}

/// Returns the log to add notes to: that of this robot, or another one if somebody has added others since.
NoteLog& RuledOut::Continued() {
  if (!log_) {
    log_ = std::make_shared<NoteLog>(bucket_m_);
  } else if (length_ != log_->size()) {
    log_ = std::make_shared<NoteLog>(*log_, length_);
  }
  return *log_;
}

bool RuledOut::Covers(const base::Point& place) const {
  const auto rules_out = [&](const HeardNote& note) { return RulesOut(note, place); };
  return (own_ && rules_out(own_->first)) || (log_ && log_->AnyNear(place, length_, rules_out));
}

bool RuledOut::RulesOut(const HeardNote& note, const base::Point& place) const {
  // A distance is at least its greater component.
  if (std::abs(place.x - note.position.x) >= bucket_m_ || std::abs(place.y - note.position.y) >= bucket_m_)
    return false;
  const double distance = Distance(place, note.position);
  if (distance < next_to_m_) return true;
  return distance < radius_m_ && !(note.loudest && Distance(place, *note.loudest) < 0.5 * cell_m_);
}

}  // namespace robotteamsim::control
