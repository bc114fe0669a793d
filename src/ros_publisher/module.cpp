// robotteamsim._ros_publisher: roscpp's publishers for Python, for messages that are bytes already.
//
// rospy has a thread per subscriber, and accepts so few connections at a time that a client of 30 robots needs minutes
// to connect to all their topics.
#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <ros/callback_queue_interface.h>
#include <ros/ros.h>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>

namespace nb = nanobind;

namespace {

// A message as it is sent.
struct Bytes {
  const char* data;
  std::size_t size;
};

}  // namespace

namespace ros {
namespace message_traits {

// roscpp compares these with those of the topic; "*" is any.
template <>
struct MD5Sum<Bytes> {
  static const char* value() { return "*"; }
  static const char* value(const Bytes&) { return "*"; }
};
template <>
struct DataType<Bytes> {
  static const char* value() { return "*"; }
  static const char* value(const Bytes&) { return "*"; }
};

}  // namespace message_traits
namespace serialization {

template <>
struct Serializer<Bytes> {
  static void write(OStream& stream, const Bytes& message) {
    std::memcpy(stream.advance(static_cast<std::uint32_t>(message.size)), message.data, message.size);
  }
  static std::uint32_t serializedLength(const Bytes& message) { return static_cast<std::uint32_t>(message.size); }
};

}  // namespace serialization
}  // namespace ros

namespace {

constexpr double kMasterTimeoutS = 30.0;

// Calls each callback at once, in roscpp's thread.
class Immediate : public ros::CallbackQueueInterface {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t) override { callback->call(); }
  void removeByID(std::uint64_t) override {}
};

void Start(const std::string& name, const std::map<std::string, std::string>& remappings) {
  ros::init(remappings, name, ros::init_options::NoSigintHandler | ros::init_options::NoRosout);
  // By default roscpp waits for a lost master without end, and no signal of Python's can interrupt it.
  ros::master::setRetryTimeout(ros::WallDuration(kMasterTimeoutS));
  ros::start();
}

class Publisher {
 public:
  Publisher(const std::string& topic, const std::string& type, const std::string& md5sum, const std::string& definition,
            bool has_header, bool latched)
      : latched_(latched) {
    static Immediate immediate;
    constexpr int kUnlimited = 0;
    const auto count = [subscribers = num_subscribers_](int change) {
      return [subscribers, change](const ros::SingleSubscriberPublisher&) { *subscribers += change; };
    };
    ros::AdvertiseOptions options(topic, kUnlimited, md5sum, type, definition, count(1), count(-1));
    options.callback_queue = &immediate;
    options.has_header = has_header;
    options.latch = latched;
    publisher_ = ros::NodeHandle().advertise(options);
    if (!publisher_) throw std::runtime_error(topic + ": cannot be advertised as " + type);
  }

  void Publish(const nb::bytes& data) const {
    const Bytes message{data.c_str(), data.size()};
    const int before = num_subscribers();
    publisher_.publish(message);
    // roscpp keeps a latched message for later subscribers only after it has sent it to those that it knows. One that
    // connects between the two gets neither.
    if (latched_ && num_subscribers() > before) publisher_.publish(message);
  }

  int num_subscribers() const { return *num_subscribers_; }

 private:
  const bool latched_;
  // Counted here, because roscpp looks each topic up in a list.
  std::shared_ptr<std::atomic<int>> num_subscribers_ = std::make_shared<std::atomic<int>>(0);
  ros::Publisher publisher_;
};

}  // namespace

NB_MODULE(_ros_publisher, module) {
  using Unlocked = nb::call_guard<nb::gil_scoped_release>;
  module.def("start", &Start, nb::arg("name"), nb::arg("remappings"), Unlocked(),
             "Start a node of roscpp in this process. Raises: RuntimeError: the name is not valid.");
  module.def("is_ok", &ros::ok, "Whether it runs: nobody has shut it down.");
  module.def("shut_down", &ros::shutdown, Unlocked(), "End it, and wait for that.");
  nb::class_<Publisher>(module, "Publisher", "A topic without a limit of messages that wait to be sent.")
      .def(nb::init<const std::string&, const std::string&, const std::string&, const std::string&, bool, bool>(),
           nb::arg("topic"), nb::arg("type"), nb::arg("md5sum"), nb::arg("definition"), nb::kw_only(),
           nb::arg("has_header"), nb::arg("latched"), Unlocked(),
           "Advertise. Raises: RuntimeError: the master does not answer, or the topic has another type already.")
      .def("publish", &Publisher::Publish, nb::arg("data"),
           "Publish a serialized message; of one with a header, roscpp writes its number.")
      .def_prop_ro("num_subscribers", &Publisher::num_subscribers);
}
