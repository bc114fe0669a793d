// robotteamsim._ros_transport: nodes in Python whose topics and services are roscpp's.
#include <geometry_msgs/Twist.h>
#include <geometry_msgs/TwistStamped.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unordered_map.h>
#include <nanobind/stl/vector.h>
#include <robotteamsim/Voice.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <unordered_map>

#include "message_queue.hpp"
#include "node.hpp"
#include "publisher.hpp"
#include "services.hpp"
#include "team_publishers.hpp"
#include "transform_listener.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace robotteamsim::ros_transport {
namespace {

using WithoutGil = nb::call_guard<nb::gil_scoped_release>;
using Matrix = nb::ndarray<const double, nb::ndim<2>, nb::device::cpu>;
using Flags = nb::ndarray<const bool, nb::ndim<1>, nb::device::cpu>;
using Scan = nb::ndarray<const float, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// How often a wait in Python's main thread looks for signals.
constexpr double kSignalPeriodS = 0.1;

RawMessage Raw(const nb::bytes& bytes) { return {std::string(bytes.c_str(), bytes.size())}; }

nb::bytes Bytes(const RawMessage& message) { return nb::bytes(message.bytes.data(), message.bytes.size()); }

std::string_view View(const nb::bytes& bytes) { return {bytes.c_str(), bytes.size()}; }

std::vector<std::string> Strings(const std::vector<nb::bytes>& all) {
  std::vector<std::string> strings;
  for (const nb::bytes& bytes : all) strings.emplace_back(View(bytes));
  return strings;
}

// A Python function that any thread may call, and the last one let go of.
std::shared_ptr<nb::callable> Shared(nb::callable function) {
  return {new nb::callable(std::move(function)), [](nb::callable* held) {
            const nb::gil_scoped_acquire gil;
            delete held;
          }};
}

Publisher::Greeting Greeting(std::optional<nb::callable> greeting) {
  if (!greeting) return {};
  return [function = Shared(std::move(*greeting))]() -> std::optional<RawMessage> {
    const nb::gil_scoped_acquire gil;
    try {
      const nb::object message = (*function)();
      if (message.is_none()) return std::nullopt;
      return Raw(nb::cast<nb::bytes>(message));
    } catch (nb::python_error& error) {
      error.discard_as_unraisable("the first message for a new subscriber could not be made");
      return std::nullopt;
    }
  };
}

ServiceServer::Handler Handler(nb::callable handler) {
  return [function = Shared(std::move(handler))](const RawMessage& request) {
    std::string problem;
    {
      const nb::gil_scoped_acquire gil;
      try {
        return Raw(nb::cast<nb::bytes>((*function)(Bytes(request))));
      } catch (nb::python_error& error) {
        problem = nb::str(error.value()).c_str();
      }
    }
    throw std::runtime_error(problem);
  };
}

// Waits without holding the interpreter; a signal's handler may close the queue meanwhile.
nb::list Take(MessageQueue& queue, double timeout_s) {
  std::deque<Received> received;
  for (double left_s = timeout_s;; left_s -= kSignalPeriodS) {
    {
      const nb::gil_scoped_release gil;
      received = queue.Take(std::min(left_s, kSignalPeriodS));
    }
    if (!received.empty() || left_s <= kSignalPeriodS || queue.is_closed()) break;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  }
  nb::list taken;
  for (const Received& one : received) taken.append(nb::make_tuple(one.topic, one.stamp_ns, Bytes(*one.message)));
  return taken;
}

Rows RowsOf(const Matrix& matrix, std::size_t rows, std::size_t columns, const char* name) {
  if (matrix.shape(0) != rows || matrix.shape(1) < columns || matrix.stride(1) != 1) {
    throw std::invalid_argument(std::string(name) + " must have a row of " + std::to_string(columns) +
                                " adjacent numbers for each of " + std::to_string(rows) + " robots");
  }
  return {matrix.data(), matrix.stride(0)};
}

std::optional<Rows> RowsOf(const std::optional<Matrix>& matrix, std::size_t rows, std::size_t columns,
                           const char* name) {
  return matrix ? std::optional(RowsOf(*matrix, rows, columns, name)) : std::nullopt;
}

const Rows* Pointer(const std::optional<Rows>& rows) { return rows ? &*rows : nullptr; }

std::vector<bool> FlagsOf(const Flags& flags, std::size_t size, const char* name) {
  if (flags.shape(0) != size) {
    throw std::invalid_argument(std::string(name) + " must have an element for each of " + std::to_string(size) +
                                " robots");
  }
  std::vector<bool> values(size);
  for (std::size_t i = 0; i < size; ++i) values[i] = flags(i);
  return values;
}

Present PresentOf(const std::optional<Flags>& present, std::size_t size) {
  return present ? FlagsOf(*present, size, "present") : Present{};
}

void PublishOdometry(OdometryTopic& topic, std::int64_t time_ns, const Matrix& poses, const Matrix& twists,
                     const std::optional<Matrix>& pose_covariances, const std::optional<Matrix>& twist_covariances,
                     const std::optional<Flags>& present) {
  const std::size_t size = topic.size();
  const Rows pose_rows = RowsOf(poses, size, 4, "poses"), twist_rows = RowsOf(twists, size, 3, "twists");
  const auto of_poses = RowsOf(pose_covariances, size, 36, "pose_covariances");
  const auto of_twists = RowsOf(twist_covariances, size, 36, "twist_covariances");
  const Present present_robots = PresentOf(present, size);
  const nb::gil_scoped_release gil;
  topic.PublishStep(time_ns, pose_rows, twist_rows, Pointer(of_poses), Pointer(of_twists), present_robots);
}

void PublishScans(ScanTopic& topic, std::int64_t time_ns, const std::vector<Scan>& ranges_m,
                  const std::optional<Flags>& present) {
  if (ranges_m.size() != topic.size()) throw std::invalid_argument("ranges_m must have an array for each robot");
  std::vector<ScanTopic::Ranges> ranges;
  for (const Scan& scan : ranges_m) ranges.push_back({scan.data(), scan.size()});
  const Present present_robots = PresentOf(present, topic.size());
  const nb::gil_scoped_release gil;
  topic.PublishStep(time_ns, ranges, present_robots);
}

void PublishContacts(ContactTopic& topic, std::int64_t time_ns, const Flags& in_contact,
                     const std::unordered_map<std::size_t, std::vector<double>>& angles_rad,
                     const std::optional<Flags>& present) {
  const std::vector<bool> touching = FlagsOf(in_contact, topic.size(), "in_contact");
  std::vector<std::vector<double>> angles(topic.size());
  for (const auto& [robot_id, of_robot] : angles_rad) angles.at(robot_id) = of_robot;
  const Present present_robots = PresentOf(present, topic.size());
  const nb::gil_scoped_release gil;
  topic.PublishStep(time_ns, touching, angles, present_robots);
}

void PublishFrames(FramesTopic& topic, std::int64_t time_ns, const Matrix& poses, const std::optional<Matrix>& origins,
                   const std::optional<Flags>& present) {
  const Rows rows = RowsOf(poses, topic.size(), 4, "poses");
  const auto origin_rows = RowsOf(origins, topic.size(), 4, "origins");
  const Present present_robots = PresentOf(present, topic.size());
  const nb::gil_scoped_release gil;
  topic.PublishStep(time_ns, rows, Pointer(origin_rows), present_robots);
}

// Pose, twist and covariances in the plane; the order is that of `sensing.readings.OdometryReading`.
nb::tuple ReadOdometry(const nb::bytes& bytes) {
  const auto odometry = Deserialized<nav_msgs::Odometry>(View(bytes));
  const auto& pose = odometry.pose.pose;
  const auto& twist = odometry.twist.twist;
  const auto& of_pose = odometry.pose.covariance;
  const auto& of_twist = odometry.twist.covariance;
  return nb::make_tuple(nb::make_tuple(pose.position.x, pose.position.y, pose.orientation.z, pose.orientation.w),
                        nb::make_tuple(twist.linear.x, twist.linear.y, twist.angular.z),
                        nb::make_tuple(of_pose[0], of_pose[1], of_pose[5], of_pose[7], of_pose[11], of_pose[35]),
                        nb::make_tuple(of_twist[0], of_twist[7], of_twist[35]));
}

// The array of numbers that begins at an offset; their count is checked before memory is taken for them.
template <class Number>
std::vector<Number> NumbersAt(std::string_view message, std::size_t begin, const char* type) {
  const auto truncated = [type] { return std::invalid_argument(std::string(type) + " is truncated"); };
  std::uint32_t count = 0;
  if (message.size() < begin + sizeof count) throw truncated();
  std::memcpy(&count, message.data() + begin, sizeof count);
  const std::string_view data = message.substr(begin + sizeof count);
  if (data.size() / sizeof(Number) < count) throw truncated();
  std::vector<Number> numbers(count);
  if (count > 0) std::memcpy(numbers.data(), data.data(), count * sizeof(Number));
  return numbers;
}

std::size_t SizeOfHeader(std::string_view message) {
  return ros::serialization::serializationLength(Deserialized<std_msgs::Header>(message));
}

std::vector<float> RangesOf(std::string_view scan) {
  constexpr std::size_t kNumLimits = 7;  // from angle_min to range_max
  return NumbersAt<float>(scan, SizeOfHeader(scan) + kNumLimits * sizeof(float), "sensor_msgs/LaserScan");
}

nb::tuple ReadContact(const nb::bytes& bytes) {
  const std::string_view contact = View(bytes);
  const std::size_t begin = SizeOfHeader(contact);
  const nb::tuple angles = nb::tuple(nb::cast(NumbersAt<double>(contact, begin + 1, "robotteamsim/Contact")));
  return nb::make_tuple(contact[begin] != 0, angles);
}

nb::tuple ReadVoice(const nb::bytes& bytes) {
  const auto voice = Deserialized<Voice>(View(bytes));
  return nb::make_tuple(voice.level_db, voice.heard != 0, nb::make_tuple(voice.local_best.x, voice.local_best.y),
                        voice.local_best_level_db);
}

nb::ndarray<nb::numpy, float, nb::ndim<1>> ReadRanges(const nb::bytes& bytes) {
  auto* ranges = new std::vector<float>(RangesOf(View(bytes)));
  const nb::capsule owner(ranges, [](void* held) noexcept { delete static_cast<std::vector<float>*>(held); });
  return {ranges->data(), {ranges->size()}, owner};
}

nb::tuple Planar(const geometry_msgs::Twist& twist) {
  return nb::make_tuple(twist.linear.x, twist.linear.y, twist.angular.z);
}

void BindNode(nb::module_& m) {
  nb::enum_<Level>(m, "Level", "Severity of a log line.")
      .value("DEBUG", Level::kDebug)
      .value("INFO", Level::kInfo)
      .value("WARNING", Level::kWarning)
      .value("ERROR", Level::kError)
      .value("FATAL", Level::kFatal);
  m.def("start_node", &StartNode, "name"_a, "arguments"_a, WithoutGil(),
        "Register this process as a node; arguments such as \"__name:=world\" rename it and its topics.");
  m.def("is_ok", &IsOk, "Return whether the node has started and is not shutting down.");
  m.def("num_writes", &NumWrites,
        "Return how often waiting messages were written; messages published now are written after two more.");
  m.def("wait_for_write", &WaitForWrite, "number"_a, "timeout_s"_a, WithoutGil(),
        "Wait for such a number, at most for a given time [s, wall]; not at all while the node is not running.");
  m.def("shut_down", &ShutDown, WithoutGil(), "Unregister topics and services; waits at most 5 s for services.");
  m.def("node_name", &NodeName, "Return the full name of this node.");
  m.def("resolved_name", &ResolvedName, "name"_a, "Return the full name of a topic, service or parameter.");
  m.def("log", &Log, "level"_a, "line"_a, WithoutGil(), "Write a line to the console and to /rosout.");
}

void BindTopics(nb::module_& m) {
  nb::class_<MessageType>(m, "MessageType", "The type of a topic.")
      .def(nb::init<std::string, std::string, std::string, bool>(), "name"_a, "md5sum"_a, "definition"_a,
           "has_header"_a);
  nb::class_<Publisher>(m, "Publisher", "Publishes serialized messages on one topic, with unlimited queues.")
      .def(
          "__init__",
          [](Publisher* self, const std::string& topic, const MessageType& type, bool latched,
             std::optional<nb::callable> greeting) {
            Publisher::Greeting greet = Greeting(std::move(greeting));
            const nb::gil_scoped_release gil;
            new (self) Publisher(topic, type, latched, std::move(greet));
          },
          "topic"_a, "type"_a, nb::kw_only(), "latched"_a, "greeting"_a.none() = nb::none(),
          nb::sig("def __init__(self, topic: str, type: MessageType, *, latched: bool,"
                  " greeting: collections.abc.Callable[[], bytes | None] | None = None) -> None"),
          "greeting: makes the first message for a new subscriber, in a new thread; None for no message.")
      .def(
          "publish",
          [](const Publisher& self, const nb::bytes& message) {
            const RawMessage raw = Raw(message);
            const nb::gil_scoped_release gil;
            self.Publish(raw);
          },
          "message"_a, "Send a serialized message; returns at once.")
      .def(
          "enqueue",
          [](const Publisher& self, const nb::bytes& message) {
            const RawMessage raw = Raw(message);
            const nb::gil_scoped_release gil;
            self.Enqueue(raw);
          },
          "message"_a, "As publish, but roscpp may delay the message until `send_enqueued`.")
      .def_prop_ro("is_wanted", &Publisher::IsWanted, "Whether there is a receiver for the next message, now or later.")
      .def_prop_ro("num_subscribers", &Publisher::num_subscribers, "Number of connected nodes.");
  m.def("send_enqueued", &Publisher::SendEnqueued, "Send all enqueued messages; returns at once.");
  nb::class_<MessageQueue>(m, "MessageQueue", "Collects the messages of several topics until they are taken.")
      .def(nb::init<>())
      .def("subscribe", &MessageQueue::Subscribe, "topic"_a, "type"_a, "keep"_a = 0, "one_publisher"_a = false,
           WithoutGil(),
           "Return the topic's index. keep: largest number of untaken messages; older ones are dropped; 0: no limit. "
           "one_publisher: only messages of the node whose message comes first are taken.")
      .def("take", &Take, "timeout_s"_a, nb::sig("def take(self, timeout_s: float) -> list[tuple[int, int, bytes]]"),
           "Return topic index, stamp [ns] and bytes of all messages in order of arrival; waits for the first one.")
      .def("close", &MessageQueue::Close, "End all waits.")
      .def("unsubscribe", &MessageQueue::Unsubscribe, WithoutGil(), "Close the queue and unregister its subscriptions.")
      .def_prop_ro("is_closed", &MessageQueue::is_closed, "Whether it is closed.")
      .def("num_publishers", &MessageQueue::num_publishers, "topic"_a, "Return the number of publishers of a topic.");
}

void BindServices(nb::module_& m) {
  nb::class_<ServiceType>(m, "ServiceType", "The type of a service.")
      .def(nb::init<std::string, std::string>(), "name"_a, "md5sum"_a);
  nb::class_<ServiceServer>(m, "ServiceServer", "Serves serialized requests, each in a new thread.")
      .def(
          "__init__",
          [](ServiceServer* self, const std::string& service, const ServiceType& type, nb::callable handler) {
            ServiceServer::Handler handle = Handler(std::move(handler));
            const nb::gil_scoped_release gil;
            new (self) ServiceServer(service, type, std::move(handle));
          },
          "service"_a, "type"_a, "handler"_a,
          nb::sig("def __init__(self, service: str, type: ServiceType, handler: collections.abc.Callable[[bytes], "
                  "bytes]) -> None"),
          "handler: its exceptions become the client's error.");
  m.def(
      "call_service",
      [](const std::string& service, const ServiceType& type, const nb::bytes& request,
         double timeout_s) -> std::optional<nb::bytes> {
        const RawMessage raw = Raw(request);
        std::optional<RawMessage> response;
        {
          const nb::gil_scoped_release gil;
          response = CallService(service, type, raw, timeout_s);
        }
        return response ? std::optional(Bytes(*response)) : std::nullopt;
      },
      "service"_a, "type"_a, "request"_a, "timeout_s"_a,
      "Return a service's response; None if it is not available in time [s, wall] or has failed.");
}

// Topic: one of the TeamTopics.
template <class Topic>
nb::class_<Topic> BindTeamTopic(nb::module_& m, const char* name, const char* doc) {
  return nb::class_<Topic>(m, name, doc)
      .def(
          "__init__",
          [](Topic* self, const std::vector<std::string>& topics, const std::vector<nb::bytes>& examples,
             bool latched) {
            const std::vector<std::string> messages = Strings(examples);
            const nb::gil_scoped_release gil;
            new (self) Topic(topics, messages, latched);
          },
          "topics"_a, "examples"_a, nb::kw_only(), "latched"_a,
          "examples: a serialized message per robot, with all constant parts.")
      .def_prop_ro("is_wanted", &Topic::IsWanted, "Whether there is a receiver for the next message of any robot.")
      .def_prop_ro("num_subscribers", &Topic::num_subscribers, "Number of connections of all robots' topics.");
}

void BindTeams(nb::module_& m) {
  BindTeamTopic<OdometryTopic>(m, "OdometryTopic", "A nav_msgs/Odometry per robot.")
      .def("publish", &PublishOdometry, "time_ns"_a, "poses"_a, "twists"_a, "pose_covariances"_a.none() = nb::none(),
           "twist_covariances"_a.none() = nb::none(), "present"_a.none() = nb::none(),
           "Publish a step: poses (n, 4) x, y, qz, qw; twists (n, 3); covariances (n, 36); present (n,), None: all.");
  BindTeamTopic<ScanTopic>(m, "ScanTopic", "A sensor_msgs/LaserScan per robot.")
      .def("publish", &PublishScans, "time_ns"_a, "ranges_m"_a, "present"_a.none() = nb::none(),
           "Publish a step: float32 ranges (beams,) of each robot [m]; present (n,), None: all.");
  BindTeamTopic<ContactTopic>(m, "ContactTopic", "A robotteamsim/Contact per robot.")
      .def("publish", &PublishContacts, "time_ns"_a, "in_contact"_a, "angles_rad"_a, "present"_a.none() = nb::none(),
           "Publish a step: in_contact (n,); angles by robot id [rad]; present (n,), None: all.");
  nb::class_<FramesTopic>(m, "FramesTopic", "The frames of all robots, in one tf2_msgs/TFMessage.")
      .def(
          "__init__",
          [](FramesTopic* self, const std::string& topic, const std::vector<nb::bytes>& examples,
             const std::vector<nb::bytes>& origins) {
            const std::vector<std::string> frames = Strings(examples), of_origins = Strings(origins);
            const nb::gil_scoped_release gil;
            new (self) FramesTopic(topic, frames, of_origins);
          },
          "topic"_a, "examples"_a, "origins"_a,
          "examples: a TFMessage per robot whose first frame moves; origins: none, or one more per robot.")
      .def_prop_ro("is_wanted", &FramesTopic::IsWanted, "Whether there is a receiver for the next message.")
      .def("publish", &PublishFrames, "time_ns"_a, "poses"_a, "origins"_a.none() = nb::none(),
           "present"_a.none() = nb::none(), "Publish a step: poses and origins (n, 4) x, y, qz, qw; present (n,).");
}

// Without an exception if there is none, because a node asks in each step.
nb::tuple Newest(const TransformListener& listener, const std::string& target, const std::string& source) {
  try {
    const PlanarTransform found = listener.Newest(target, source);
    return nb::make_tuple(nb::make_tuple(found.stamp_ns, found.x, found.y, found.yaw), "");
  } catch (const tf2::TransformException& problem) {
    return nb::make_tuple(nb::none(), problem.what());
  }
}

void BindTransforms(nb::module_& m) {
  nb::class_<TransformListener>(m, "TransformListener", "The transforms on /tf and /tf_static.")
      .def(nb::init<>(), WithoutGil())
      .def("newest", &Newest, "target"_a, "source"_a,
           nb::sig("def newest(self, target: str, source: str) -> tuple[tuple[int, float, float, float] | None, str]"),
           "Return stamp [ns], x, y [m] and yaw [rad] of the source frame in the target frame, and \"\"; None and the"
           " reason if there is no transform. The stamp is 0 if all transforms between them are static.")
      .def("clear", &TransformListener::Clear, "Forget all transforms but static ones: time has jumped back.");
}

void BindReading(nb::module_& m) {
  m.def("read_odometry", &ReadOdometry, "message"_a,
        nb::sig("def read_odometry(message: bytes) -> tuple[tuple[float, float, float, float],"
                " tuple[float, float, float], tuple[float, float, float, float, float, float],"
                " tuple[float, float, float]]"),
        "Return x, y, qz, qw; forward, left, counter-clockwise; xx, xy, xa, yy, ya, aa of the pose's covariance; the"
        " variances of the twist. Raises ValueError: the message is truncated.");
  m.def("read_contact", &ReadContact, "message"_a,
        nb::sig("def read_contact(message: bytes) -> tuple[bool, tuple[float, ...]]"),
        "Return whether there is contact, and the angles of a robotteamsim/Contact [rad]. Raises ValueError.");
  m.def("read_voice", &ReadVoice, "message"_a,
        nb::sig("def read_voice(message: bytes) -> tuple[float, bool, tuple[float, float], float]"),
        "Return level [dB], heard, local best [m] and its level [dB] of a robotteamsim/Voice. Raises ValueError.");
  m.def("read_ranges", &ReadRanges, "message"_a,
        "Return the ranges of a sensor_msgs/LaserScan as float32, shape (beams,) [m]. Raises ValueError.");
  m.def(
      "read_twist", [](const nb::bytes& bytes) { return Planar(Deserialized<geometry_msgs::Twist>(View(bytes))); },
      "message"_a, nb::sig("def read_twist(message: bytes) -> tuple[float, float, float]"),
      "Return a geometry_msgs/Twist: forward, left [m/s], counter-clockwise [rad/s]. Raises ValueError.");
  m.def(
      "read_twist_stamped",
      [](const nb::bytes& bytes) { return Planar(Deserialized<geometry_msgs::TwistStamped>(View(bytes)).twist); },
      "message"_a, nb::sig("def read_twist_stamped(message: bytes) -> tuple[float, float, float]"),
      "Return the twist of a geometry_msgs/TwistStamped, as `read_twist`.");
}

NB_MODULE(_ros_transport, m) {
  m.doc() = "Python nodes with topics and services of roscpp.";
  // A node ends while services and publishers are still held by it.
  nb::set_leak_warnings(false);
  BindNode(m);
  BindTopics(m);
  BindServices(m);
  BindTeams(m);
  BindTransforms(m);
  BindReading(m);
}

}  // namespace
}  // namespace robotteamsim::ros_transport
