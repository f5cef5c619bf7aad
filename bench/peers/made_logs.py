"""Small logs with random values, written from the published layouts of their formats: DataFlash and ULog; and
telemetry, which pymavlink itself packs."""

import struct

import numpy
from pymavlink.dialects.v20 import ardupilotmega as dialect

RANDOM_SEED = 7
RATE_HZ = 50.0

# ------------------------------------------------------------------------------------------------ ArduPilot DataFlash

CODES = {
    "b": "b", "B": "B", "h": "h", "H": "H", "i": "i", "I": "I", "q": "q", "Q": "Q", "f": "f", "d": "d",
    "c": "h", "C": "H", "e": "i", "E": "I", "L": "i", "n": "4s", "N": "16s", "Z": "64s",
}  # fmt: skip
UNITS = {"s": b"s", "#": b"instance", "d": b"deg", "k": b"deg/s", "m": b"m", "n": b"m/s", "o": b"m/s/s",
         "D": b"deglatitude", "U": b"deglongitude", "P": b"Pa", "O": b"degC", "G": b"Gauss", "E": b"rad/s"}  # fmt: skip
MULTIPLIERS = {"F": 1e-6, "B": 1e-2, "C": 1e-3, "0": 1.0}
# Type, name, characters, labels, units and multipliers by column.
MESSAGES = [
    (1, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ", "s#EEEooo", "F-000000"),
    (2, "ATT", "QccCdh", "TimeUS,Roll,Pitch,Yaw,Raw,Rate", "sddd-k", "F----B"),
    (3, "FIX", "QBLLeEf", "TimeUS,I,Lat,Lng,Alt,Up,Spd", "s#DUmmn", "F-----0"),
    (4, "BARO", "QfhIqb", "TimeUS,Press,Temp,Count,Long,Sign", "sPO---", "F0B---"),
    (5, "MAG", "Qhhh", "TimeUS,X,Y,Z", "sGGG", "FCCC"),
]


def packed(type_, characters, values):
    codes = "".join(CODES[c] for c in characters)
    return struct.pack("<BBB" + codes, 0xA3, 0x95, type_, *values)


def random_value(random, character):
    code = CODES[character]
    if code in "fd":
        return float(numpy.float32(random.normal(0.0, 100.0)))
    size = 8 * struct.calcsize(code)
    low, high = (-(2 ** (size - 1)), 2 ** (size - 1) - 1) if code.islower() else (0, 2**size - 1)
    # Doubles hold integers up to 2^53.
    return int(random.integers(max(low, -(2**53)), min(high, 2**53)))


def dataflash(rows=100):
    random = numpy.random.default_rng(RANDOM_SEED)
    schema = [
        (128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"),
        (10, "UNIT", "QbZ", "TimeUS,Id,Label"),
        (11, "MULT", "Qbd", "TimeUS,Id,Mult"),
        (12, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds"),
    ]
    out = b""
    for type_, name, characters, labels in schema + [m[:4] for m in MESSAGES]:
        length = 3 + struct.calcsize("<" + "".join(CODES[c] for c in characters))
        values = (type_, length, name.encode(), characters.encode(), labels.encode())
        out += packed(128, "BBnNZ", values)
    for id_, label in UNITS.items():
        out += packed(10, "QbZ", (0, ord(id_), label))
    for id_, factor in MULTIPLIERS.items():
        out += packed(11, "Qbd", (0, ord(id_), factor))
    for type_, _, _, _, units, multipliers in MESSAGES:
        out += packed(12, "QBNN", (0, type_, units.encode(), multipliers.encode()))
    for row in range(rows):
        time_us = 1_000_000 + int(row * 1e6 / RATE_HZ)
        for type_, _, characters, labels, _, _ in MESSAGES:
            for instance in range(2 if ",I," in labels else 1):
                values = [random_value(random, c) for c in characters]
                values[0] = time_us
                if ",I," in labels:
                    values[1] = instance
                out += packed(type_, characters, values)
    return out


# ------------------------------------------------------------------------------------------------------------ PX4 ULog

ULOG_TYPES = {
    "int8_t": "b", "uint8_t": "B", "int16_t": "h", "uint16_t": "H", "int32_t": "i", "uint32_t": "I", "int64_t": "q",
    "uint64_t": "Q", "float": "f", "double": "d", "bool": "?",
}  # fmt: skip
ULOG_TOPICS = {
    "sensor_made": [("uint64_t", "timestamp", 1), ("float", "x", 1), ("float", "xyz", 3), ("int16_t", "raw", 1)],
    "all_types": [
        ("uint64_t", "timestamp", 1),
        ("double", "wide", 2),
        ("uint64_t", "u64", 1),
        ("int64_t", "i64", 1),
        ("uint32_t", "u32", 1),
        ("int32_t", "i32", 1),
        ("uint16_t", "u16", 1),
        ("uint8_t", "u8", 2),
        ("int8_t", "i8", 1),
        ("bool", "flag", 1),
    ],
    "vehicle_attitude": [("uint64_t", "timestamp", 1), ("float", "rollspeed", 1), ("float", "q", 4)],
}
# Topics in the order of their numbers, with the instance of each.
ULOG_SUBSCRIPTIONS = [("sensor_made", 0), ("sensor_made", 1), ("all_types", 0), ("vehicle_attitude", 0)]


def ulog_message(kind, payload):
    return struct.pack("<HB", len(payload), ord(kind)) + payload


def ulog(rows=100):
    random = numpy.random.default_rng(RANDOM_SEED)
    out = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 1000)
    out += ulog_message("B", bytes(40))
    for topic, fields in ULOG_TOPICS.items():
        text = ";".join(f"{type_}{f'[{n}]' if n > 1 else ''} {name}" for type_, name, n in fields)
        out += ulog_message("F", f"{topic}:{text};".encode())
    for number, (topic, instance) in enumerate(ULOG_SUBSCRIPTIONS):
        out += ulog_message("A", struct.pack("<BH", instance, number) + topic.encode())
    for row in range(rows):
        for number, (topic, _) in enumerate(ULOG_SUBSCRIPTIONS):
            codes, values = "", []
            for type_, _, count in ULOG_TOPICS[topic]:
                codes += ULOG_TYPES[type_] * count
                for _ in range(count):
                    code = ULOG_TYPES[type_]
                    values.append(bool(random.integers(2)) if code == "?" else random_value(random, code))
            values[0] = 1000 + int(row * 1e6 / RATE_HZ)
            out += ulog_message("D", struct.pack("<H" + codes, number, *values))
    return out


# ------------------------------------------------------------------------------------------------- MAVLink telemetry

TELEMETRY = [
    "ATTITUDE", "ATTITUDE_QUATERNION", "LOCAL_POSITION_NED", "GLOBAL_POSITION_INT", "GPS_RAW_INT", "VFR_HUD", "RAW_IMU",
    "SCALED_IMU", "SCALED_IMU2", "SCALED_IMU3", "HIGHRES_IMU", "SCALED_PRESSURE", "SCALED_PRESSURE2",
    "SERVO_OUTPUT_RAW", "ACTUATOR_OUTPUT_STATUS", "ACTUATOR_CONTROL_TARGET", "RC_CHANNELS", "WIND", "WIND_COV", "RPM",
]  # fmt: skip
TYPE_CODES = {
    "char": "c", "uint8_t": "B", "int8_t": "b", "uint16_t": "H", "int16_t": "h", "uint32_t": "I", "int32_t": "i",
    "uint64_t": "Q", "int64_t": "q", "float": "f", "double": "d",
}  # fmt: skip
BEGIN_US = 1_700_000_000_000_000


def telemetry(rows=100):
    """Every kind of message that is read, at each moment one of each, with times that agree with the packets' stamps.

    Fields that number sensors or ports are 0."""
    random = numpy.random.default_rng(RANDOM_SEED)
    sender = dialect.MAVLink(None, srcSystem=1, srcComponent=1)
    out = b""
    for row in range(rows):
        time_us = int(row * 1e6 / RATE_HZ)
        heartbeat = dialect.MAVLink_heartbeat_message(1, 3, 0, 0, 4, 3)
        messages = [heartbeat]
        for name in TELEMETRY:
            class_ = getattr(dialect, f"MAVLink_{name.lower()}_message")
            values = []
            for field, type_, count in zip(class_.fieldnames, class_.fieldtypes, array_lengths(class_), strict=True):
                if field == "time_boot_ms":
                    values.append(1000 + time_us // 1000)
                elif field == "time_usec":
                    values.append(1_000_000 + time_us)
                elif field in ("id", "port", "group_mlx"):
                    values.append(0)
                else:
                    code = TYPE_CODES[type_]
                    # All bits set, which is "not known" in some fields, now and then.
                    full = row % 10 == 3 and code in "BHI"
                    numbers = [
                        2 ** (8 * struct.calcsize(code)) - 1 if full else random_value(random, code)
                        for _ in range(max(count, 1))
                    ]
                    values.append(numbers if count else numbers[0])
            messages.append(class_(*values))
        for message in messages:
            out += struct.pack(">Q", BEGIN_US + time_us) + message.pack(sender)
    return out


def array_lengths(class_):
    """Of the fields in the order of their names; 0 of those that are no arrays."""
    by_name = dict(zip(class_.ordered_fieldnames, class_.array_lengths, strict=True))
    return [by_name[name] for name in class_.fieldnames]
