// A DDS program of another vendor, for the tests: what is published on rt/to_fast comes back on rt/from_fast in
// capitals. Both are std_msgs/msg/String, as ROS 2 names and encodes it. The argument is the domain.

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <unistd.h>

using namespace eprosima::fastdds::dds;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

namespace {

constexpr std::uint32_t max_text = 1024;

// std_msgs/msg/String in the first version of CDR, little endian: four bytes of encapsulation, the length
// with the closing zero, the bytes.
class StringType : public TopicDataType {
public:
    StringType() {
        setName("std_msgs::msg::dds_::String_");
        m_typeSize = max_text + 9;
        m_isGetKeyDefined = false;
        auto_fill_type_object(false);
        auto_fill_type_information(false);
    }

    bool serialize(void* data, SerializedPayload_t* payload) override {
        const std::string& text = *static_cast<std::string*>(data);
        const std::uint32_t length = static_cast<std::uint32_t>(text.size()) + 1;
        const unsigned char head[4] = {0, 1, 0, 0};
        std::memcpy(payload->data, head, 4);
        std::memcpy(payload->data + 4, &length, 4);
        std::memcpy(payload->data + 8, text.c_str(), length);
        payload->length = 8 + length;
        return true;
    }

    bool deserialize(SerializedPayload_t* payload, void* data) override {
        std::uint32_t length = 0;
        if (payload->length < 9 || payload->data[1] != 1) return false;
        std::memcpy(&length, payload->data + 4, 4);
        if (length == 0 || length > payload->length - 8) return false;
        static_cast<std::string*>(data)->assign(reinterpret_cast<char*>(payload->data + 8), length - 1);
        return true;
    }

    std::function<std::uint32_t()> getSerializedSizeProvider(void*) override {
        return [] { return max_text + 9; };
    }
    void* createData() override { return new std::string; }
    void deleteData(void* data) override { delete static_cast<std::string*>(data); }
    bool getKey(void*, InstanceHandle_t*, bool) override { return false; }
};

class Echo : public DataReaderListener {
public:
    explicit Echo(DataWriter* out) : out_(out) {}

    void on_data_available(DataReader* reader) override {
        std::string text;
        SampleInfo info;
        while (reader->take_next_sample(&text, &info) == ReturnCode_t::RETCODE_OK) {
            if (!info.valid_data) continue;
            for (char& letter : text) letter = static_cast<char>(std::toupper(letter));
            out_->write(&text);
        }
    }

private:
    DataWriter* out_;
};

}  // namespace

int main(int, char** argv) {
    DomainParticipantQos qos;
    auto loopback = std::make_shared<UDPv4TransportDescriptor>();
    loopback->interfaceWhiteList = {"127.0.0.1"};
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports = {loopback};
    DomainParticipant* participant =
        DomainParticipantFactory::get_instance()->create_participant(std::atoi(argv[1]), qos);
    if (participant == nullptr) return 1;
    TypeSupport type(new StringType);
    type.register_type(participant);
    Topic* in = participant->create_topic("rt/to_fast", type.get_type_name(), TOPIC_QOS_DEFAULT);
    Topic* out = participant->create_topic("rt/from_fast", type.get_type_name(), TOPIC_QOS_DEFAULT);
    DataWriter* writer = participant->create_publisher(PUBLISHER_QOS_DEFAULT)->create_datawriter(out, DATAWRITER_QOS_DEFAULT);
    Echo echo(writer);
    DataReaderQos reliable = DATAREADER_QOS_DEFAULT;
    reliable.reliability().kind = RELIABLE_RELIABILITY_QOS;
    participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT)->create_datareader(in, reliable, &echo);
    pause();
    return 0;
}
