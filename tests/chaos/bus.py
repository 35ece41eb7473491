"""The services' network as a test sees it: who said something when, and packets of our own. LCM's wire format: a small message is
'LC02', number, channel, 0, bytes; a large one is cut into fragments that begin with 'LC03'."""
import os
import random
import select
import socket
import struct
import threading
import time

GROUP, PORT = "239.255.76.67", 7667
SMALL, FRAGMENT = b"LC02", b"LC03"


def channel_of(packet):
    """Name of the channel; empty for fragments but the first."""
    if packet[:4] == SMALL:
        return packet[8:].split(b"\0", 1)[0].decode(errors="replace")
    if packet[:4] == FRAGMENT and packet[16:18] == b"\0\0":
        return packet[20:].split(b"\0", 1)[0].decode(errors="replace")
    return ""


class Listener(threading.Thread):
    """Notes when every channel was heard last, and keeps its last packet."""

    def __init__(self, heard):
        """@param heard of coach-doctor: packet -> station, service, facts"""
        super().__init__(daemon=True)
        self.heard, self.lock = heard, threading.Lock()
        self.last, self.packets, self.counts, self.health = {}, {}, {}, {}
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(GROUP) + bytes(4))
        self.socket.bind(("", PORT))
        self.start()

    def run(self):
        while True:
            select.select([self.socket], [], [])
            packet = self.socket.recv(65536)
            channel = channel_of(packet)
            if not channel:
                continue
            with self.lock:
                self.last[channel] = time.monotonic()
                self.packets[channel] = packet
                self.counts[channel] = self.counts.get(channel, 0) + 1
                news = self.heard(packet) if channel.endswith("/SERVICE_HEALTH") else None
                if news and "pid" in news[2]:
                    self.health[news[1]] = {**news[2], "time": self.last[channel]}

    def heard_since(self, channel, moment):
        with self.lock:
            return self.last.get(channel, 0) > moment

    def count(self, channel):
        with self.lock:
            return self.counts.get(channel, 0)

    def of_service(self, service):
        with self.lock:
            return dict(self.health.get(service, {}))


class Hostile:
    """Packets that no service of ours would send."""

    def __init__(self, listener, station, seed):
        self.listener, self.station, self.random = listener, station, random.Random(seed)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def packet(self):
        kind = self.random.randrange(6)
        with self.listener.lock:
            known = sorted(self.listener.packets)
            real = self.listener.packets[self.random.choice(known)]
        name = f"{self.station}/{self.random.choice(['PART_POSES', 'DETECTIONS', 'OPERATOR_COMMAND', 'TASK', 'ROBOT_STATUS'])}".encode()
        if kind == 0:  # nonsense under a known name
            return SMALL + os.urandom(4) + name + b"\0" + self.random.randbytes(self.random.randrange(2000))
        if kind == 1:  # cut off
            return real[:self.random.randrange(len(real))]
        if kind == 2:  # too long
            return (real + self.random.randbytes(self.random.randrange(1, 300)))[:65000]
        if kind == 3:  # a known type whose counts and lengths are wild, and whose end is missing
            head, wild = real.find(b"\0", 8) + 9, bytearray(real)
            for _ in range(8):
                at = self.random.randrange(min(head, len(wild)), len(wild) + 1)
                wild[at:at + 4] = self.random.choice([b"\x7f\xff\xff\xff", b"\x80\0\0\0", b"\xff\xff\xff\xff"])
            return bytes(wild[:len(real) - self.random.randrange(1, 20)])
        if kind == 4:  # a piece of a message of 256 MB that never comes
            return FRAGMENT + struct.pack(">IIIHH", self.random.randrange(1 << 32), 1 << 28, self.random.randrange(1 << 28),
                                          self.random.choice([0, 1, 4000]), 4096) + name + b"\0" + bytes(1000)
        return self.random.randbytes(self.random.randrange(1, 300))  # nothing at all

    def flood(self, seconds):
        """@return packets sent"""
        count, end = 0, time.monotonic() + seconds
        while time.monotonic() < end:
            for _ in range(20):
                self.socket.sendto(self.packet(), (GROUP, PORT))
                count += 1
            time.sleep(0.005)
        return count
