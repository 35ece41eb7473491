#!/usr/bin/env python3
"""A robot that speaks qi messaging, for tests. It shares no code with the client: every byte is packed here, after the
protocol's description. Service, method and object ids differ in every run.

usage: fake_qi_server.py [--port N] [--seed N] [--user U --token T] [--tls CERT KEY] [--no-authenticate] [--seven]
                         [--two-processes] [--two-rounds] [--capability-first] [--ghost NAME] [--odd-messages]

Prints one JSON line an event on standard output: {"listening": port}, {"call": "ALMotion.rest", "arguments": [...]},
{"done": ...}. Takes orders on standard input, one a line:
  hang NAME     calls of service.method NAME get no answer            fail NAME     they get an error
  ok NAME       they work again                                       touch 1|0     the head is touched
  drop          all connections are cut                               standing      the robot does not sit
  freeze        nothing is answered any more, no connection is closed cut           half a message, then the end
"""
import argparse, json, random, selectors, socket, ssl, struct, sys, threading, time

# ---- bytes -----------------------------------------------------------------------------------------------------------
def u32(n): return struct.pack('<I', n)
def text(s): b = s if isinstance(s, bytes) else s.encode(); return u32(len(b)) + b
def dynamic(signature, payload): return text(signature) + payload
def header(message_id, size, kind, service, obj, action, flags=0):
    return bytes.fromhex('42dead42') + struct.pack('<IIHBBIII', message_id, size, 0, kind, flags, service, obj, action)

class Reader:
    def __init__(self, data): self.data, self.at = data, 0
    def take(self, n):
        if self.at + n > len(self.data): raise ValueError('payload too short')
        piece = self.data[self.at:self.at + n]; self.at += n
        return piece
    def unpack(self, code): return struct.unpack('<' + code, self.take(struct.calcsize(code)))[0]
    def text(self): return self.take(self.unpack('I'))

def split(signature):
    """The types that stand side by side in a signature."""
    pieces, depth, start = [], 0, 0
    for i, c in enumerate(signature):
        depth += (c in '[({') - (c in '])}')
        if depth == 0:
            pieces.append(signature[start:i + 1]); start = i + 1
    return pieces

def read(reader, signature):
    c = signature[0]
    if c in 'bcCwWiIlLfd':
        value = reader.unpack({'b': 'B', 'c': 'b', 'C': 'B', 'w': 'h', 'W': 'H', 'i': 'i', 'I': 'I', 'l': 'q', 'L': 'Q', 'f': 'f', 'd': 'd'}[c])
        return bool(value) if c == 'b' else value
    if c == 's': return reader.text().decode()
    if c == 'r': return {'raw': len(reader.text())}
    if c == 'm': return read(reader, reader.text().decode())
    if c == '[': return [read(reader, signature[1:-1]) for _ in range(reader.unpack('I'))]
    if c == '(': return [read(reader, piece) for piece in split(signature[1:-1])]
    if c == '{':
        key, value = split(signature[1:-1])
        return {read(reader, key): read(reader, value) for _ in range(reader.unpack('I'))}
    raise ValueError('cannot read ' + signature)

# ---- the robot -------------------------------------------------------------------------------------------------------
LIMITS = {'HeadYaw': (-2.0857, 2.0857), 'HeadPitch': (-0.672, 0.5149), 'LShoulderPitch': (-2.0857, 2.0857),
          'LShoulderRoll': (-0.3142, 1.3265), 'LElbowYaw': (-2.0857, 2.0857), 'LElbowRoll': (-1.5446, -0.0349),
          'LWristYaw': (-1.8238, 1.8238), 'RShoulderPitch': (-2.0857, 2.0857), 'RShoulderRoll': (-1.3265, 0.3142),
          'RElbowYaw': (-2.0857, 2.0857), 'RElbowRoll': (0.0349, 1.5446), 'RWristYaw': (-1.8238, 1.8238)}
floats = lambda values: u32(len(values)) + b''.join(struct.pack('<f', v) for v in values)
VOID = ('v', lambda robot, args: b'')

# service -> list of (method, parameters, return signature, answer(robot, arguments) -> bytes)
SERVICES = {
    'ALSystem': [('systemVersion', '()', 's', lambda r, a: text('2.8.6.23'))],
    'ALMotion': [
        ('wakeUp', '()', *VOID), ('rest', '()', *VOID), ('setStiffnesses', '(mm)', *VOID), ('setAngles', '(mmf)', *VOID),
        ('angleInterpolation', '(mmmb)', 'v', lambda r, a: r.move(a)),
        ('getAngles', '(mb)', '[f]', lambda r, a: floats([r.angles[n] for n in a[0]])),
        ('getLimits', '(s)', 'm', lambda r, a: dynamic('[[f]]', u32(1) + floats([*LIMITS[a[0]], 8.26, 1.2]))),
        ('killAll', '()', *VOID), ('killTasksUsingResources', '([s])', *VOID), ('setBreathEnabled', '(sb)', *VOID),
        ('setIdlePostureEnabled', '(sb)', *VOID), ('setCollisionProtectionEnabled', '(sb)', 'b', lambda r, a: b'\x01'),
        ('getPosition', '(sib)', '[f]', lambda r, a: floats([0.1] * 6)),
        ('getRobotConfig', '()', 'm', lambda r, a: dynamic('[[m]]', u32(2) + u32(1) + dynamic('s', text('Model Type')) + u32(1) + dynamic('s', text('naoH25'))))],
    'ALTextToSpeech': [
        ('say', '(ss)', 'v', lambda r, a: r.say(a)), ('say', '(s)', 'v', lambda r, a: r.say(a)), ('stopAll', '()', 'v', lambda r, a: r.hush()),
        ('setLanguage', '(s)', *VOID), ('getAvailableLanguages', '()', '[s]', lambda r, a: u32(2) + text('English') + text('French')),
        ('setVolume', '(f)', *VOID), ('getVolume', '()', 'f', lambda r, a: struct.pack('<f', 0.5)), ('setParameter', '(sf)', *VOID)],
    'ALAnimatedSpeech': [('say', '(s)', *VOID), ('say', '(sm)', *VOID), ('setBodyLanguageModeFromStr', '(s)', *VOID)],
    'ALAutonomousLife': [('setState', '(s)', *VOID), ('getState', '()', 's', lambda r, a: text('disabled')),
                         ('setAutonomousAbilityEnabled', '(sb)', *VOID)],
    'ALRobotPosture': [('goToPosture', '(sf)', 'b', lambda r, a: r.sit()), ('getPosture', '()', 's', lambda r, a: text(r.posture))],
    'ALLeds': [('fadeRGB', '(sffff)', *VOID), ('fadeRGB', '(ssf)', *VOID), ('fadeRGB', '(sif)', *VOID), ('on', '(s)', *VOID)],
    'ALAudioDevice': [('setOutputVolume', '(i)', *VOID), ('setParameter', '(si)', *VOID), ('flushAudioOutputs', '()', *VOID),
                      ('sendRemoteBufferToOutput', '(im)', 'b', lambda r, a: b'\x01')],
    'ALBattery': [('getBatteryCharge', '()', 'i', lambda r, a: struct.pack('<i', 83))],
    'ALMemory': [('subscriber', '(s)', 'o', lambda r, a: r.subscriber(a[0]))],
}

class Robot:
    def __init__(self, options):
        self.options, self.random = options, random.Random(options.seed)
        self.hanging, self.failing, self.lock, self.frozen = set(), set(), threading.RLock(), False
        self.posture, self.angles, self.speaking = 'Sit', {n: 0.5 * (a + b) for n, (a, b) in LIMITS.items()}, 0
        ids = self.random.sample(range(2, 4000), len(SERVICES))
        self.service_ids = dict(zip(SERVICES, ids))
        self.method_ids, self.methods = {}, {}
        for service, methods in SERVICES.items():
            order = list(enumerate(methods)); self.random.shuffle(order)
            for offset, (index, method) in enumerate(order):
                self.methods[service, 100 + 3 * offset + self.random.randrange(3)] = method
        self.signal_id = self.random.randrange(100, 200)
        self.subscribers = {}  # object id -> event name
        self.links = []        # (connection, service, object, signal)

    def say(self, arguments):
        self.speaking = token = self.random.random()
        end = time.time() + 0.3 + 0.04 * len(arguments[0])
        while time.time() < end and self.speaking == token: time.sleep(0.01)
        log({'said': arguments[0], 'complete': self.speaking == token})
        return b''
    def hush(self): self.speaking = 0; return b''
    def sit(self): self.posture = 'Sit' if not self.options.will_not_sit else self.posture; return b'\x01'
    def move(self, arguments):
        names, angles, times, absolute = arguments
        for name, row, moments in zip(names, angles, times):
            low, high = LIMITS[name]
            if len(row) != len(moments) or any(not low - 1e-4 <= a <= high + 1e-4 for a in row): raise ValueError('angle outside its limits: ' + name)
            if any(b <= a for a, b in zip([0] + moments, moments)): raise ValueError('times do not grow')
        time.sleep(times[0][-1])
        for name, row in zip(names, angles): self.angles[name] = row[-1]
        return b''
    def subscriber(self, event):
        number = self.random.randrange(10, 1 << 20)
        self.subscribers[number] = event
        signal = u32(1) + u32(self.signal_id) + u32(self.signal_id) + text('signal') + text('(m)')
        return u32(0) + signal + u32(0) + text('') + u32(self.service_ids['ALMemory']) + u32(number)

    def meta_object(self, methods):
        out = u32(len(methods))
        for uid, (name, parameters, returned, _) in methods:
            out += u32(uid) + u32(uid) + text(returned) + text(name) + text(parameters) + text('') + u32(0) + text('')
        return out + u32(0) + u32(0) + text('')

INFO = '(sIsI[s]s)<ServiceInfo,name,serviceId,machineId,processId,endpoints,sessionId>'
INFO7 = '(sIsI[s]ss)<ServiceInfo,name,serviceId,machineId,processId,endpoints,sessionId,objectUid>'
output_lock = threading.Lock()
def log(event):
    with output_lock: print(json.dumps(event), flush=True)

class Connection(threading.Thread):
    def __init__(self, robot, stream, port):
        super().__init__(daemon=True)
        self.robot, self.stream, self.port, self.lock = robot, stream, port, threading.Lock()
        self.authenticated = False
    def send(self, data):
        try:
            with self.lock: self.stream.sendall(data)
        except OSError: pass
    def answer(self, call, kind, payload, flags=0):
        if self.robot.options.odd_messages:  # of unknown types, with unknown flags, to nobody, too late
            self.send(header(call['id'], 4, 77, 3, 3, 3, 0xfe) + b'junk' + header(call['id'] + 999, 0, 2, 1, 1, 2) + header(0, 3, 5, 9, 9, 9) + b'abc')
            flags |= 0xf0
        self.send(header(call['id'], len(payload), kind, call['service'], call['object'], call['action'], flags) + payload)
    def error(self, call, words): self.answer(call, 3, dynamic('s', text(words)))

    def run(self):
        data = b''
        try:
            while True:
                piece = self.stream.recv(65536)
                if not piece: return
                data += piece
                while len(data) >= 28:
                    magic, number, size, version, kind, flags, service, obj, action = struct.unpack('<4sIIHBBIII', data[:28])
                    if magic != bytes.fromhex('42dead42') or version != 0: log({'violation': 'header'}); return
                    if len(data) < 28 + size: break
                    call = {'id': number, 'kind': kind, 'service': service, 'object': obj, 'action': action}
                    payload, data = data[28:28 + size], data[28 + size:]
                    self.handle(call, payload)
        except OSError: pass
        finally:
            try: self.stream.close()
            except OSError: pass

    def handle(self, call, payload):
        if self.robot.frozen: return
        if call['kind'] not in (1, 4): log({'violation': 'message type %d' % call['kind']}); return
        where = (call['service'], call['object'], call['action'])
        if where == (0, 0, 8): return self.authenticate(call, payload)
        if not self.authenticated and not self.robot.options.no_authenticate:
            log({'violation': 'call before login'}); return self.error(call, 'not authenticated')
        if call['service'] == 1: return self.directory(call, payload)
        for name, number in self.robot.service_ids.items():
            if number == call['service']: return self.service(call, name, payload)
        self.error(call, 'no such service')

    def authenticate(self, call, payload):
        options = self.robot.options
        if options.no_authenticate: return self.error(call, 'unknown function')
        given = read(Reader(payload), '{sm}')
        log({'login': {key: value for key, value in given.items() if key.startswith('auth')}, 'capabilities': sorted(key for key in given if not key.startswith('auth'))})
        if options.capability_first: self.send(header(7, 4, 6, 0, 0, 0) + u32(0))
        token = options.token
        if options.two_rounds:  # a first token is exchanged for one of the robot's own
            token = 'fresh' if getattr(self, 'asked_again', False) else options.token
            if given.get('auth_token') == options.token and not getattr(self, 'asked_again', False):
                self.asked_again = True
                return self.answer(call, 2, u32(2) + text('__qi_auth_state') + dynamic('I', u32(2)) + text('auth_newToken') + dynamic('s', text('fresh')))
        refused = token and (given.get('auth_user'), given.get('auth_token')) != (options.user, token)
        if refused:
            self.error(call, 'authentication failed'); self.stream.shutdown(socket.SHUT_RDWR); return
        self.authenticated = True
        self.answer(call, 2, u32(2) + text('ClientServerSocket') + dynamic('b', b'\x01') + text('__qi_auth_state') + dynamic('I', u32(3)))
        self.send(header(0, 4, 6, 0, 0, 0) + u32(0))  # a capability message, out of the blue

    def directory(self, call, payload):
        info = INFO7 if self.robot.options.seven else INFO
        if call['action'] == 2:
            methods = [(100, ('service', '(s)', info, None)), (101, ('services', '()', '[' + info + ']', None)), (108, ('machineId', '()', 's', None))]
            return self.answer(call, 2, self.robot.meta_object(methods))
        if call['action'] != 100: return self.error(call, 'no such method')
        name = read(Reader(payload), '(s)')[0]
        if name not in SERVICES or name in self.robot.options.without: return self.error(call, "Cannot find service '" + name + "' in index")
        scheme = 'tcps' if self.robot.options.tls else 'tcp'
        port = self.robot.options.second_port if self.robot.options.two_processes and name == 'ALMotion' else self.port
        endpoints = ['%s://127.0.0.1:%d' % (scheme, port), '%s://192.0.2.7:%d' % (scheme, port)]
        if self.robot.options.ghost == name: endpoints = ['%s://127.0.0.1:1' % scheme]  # nobody listens there
        out = text(name) + u32(self.robot.service_ids[name]) + text('machine') + u32(77) + u32(len(endpoints)) + b''.join(map(text, endpoints)) + text('session')
        self.answer(call, 2, out + (text(b'\xff\x00\xfe binary') if self.robot.options.seven else b''))

    def service(self, call, name, payload):
        robot = self.robot
        if call['action'] == 2 and call['object'] == 1:
            return self.answer(call, 2, robot.meta_object([(uid, m) for (service, uid), m in robot.methods.items() if service == name]))
        if call['action'] == 0:  # registerEvent
            _, signal, link = read(Reader(payload), '(IIL)')
            robot.links.append((self, call['service'], call['object'], signal))
            log({'registered': robot.subscribers.get(call['object'], '?')})
            return self.answer(call, 2, struct.pack('<Q', link))
        method = robot.methods.get((name, call['action']))
        if method is None or call['object'] != 1:
            log({'violation': 'no method %s.%d' % (name, call['action'])}); return self.error(call, 'no such method')
        threading.Thread(target=self.carry_out, args=(call, name, method, payload), daemon=True).start()

    def carry_out(self, call, service, method, payload):
        name, parameters, returned, answer = method
        full, robot = service + '.' + name, self.robot
        try:
            reader = Reader(payload); arguments = read(reader, parameters)
            if reader.at != len(payload): raise ValueError('bytes left over')
        except Exception as problem:
            log({'violation': '%s%s: %s' % (full, parameters, problem)}); return self.error(call, str(problem))
        log({'call': full, 'parameters': parameters, 'arguments': arguments, 'time': time.time()})
        if full in robot.hanging: return
        if full in robot.failing: return self.error(call, full + ' has failed')
        try: result = answer(robot, arguments)
        except Exception as problem:
            log({'violation': '%s: %s' % (full, problem)}); return self.error(call, str(problem))
        self.answer(call, 2, result)

def serve(robot, listener, port, connections):
    while True:
        stream, _ = listener.accept()
        stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if robot.options.tls:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER); context.load_cert_chain(*robot.options.tls)
            try: stream = context.wrap_socket(stream, server_side=True)
            except (ssl.SSLError, OSError): continue
        connection = Connection(robot, stream, port)
        connections.append(connection); connection.start()

def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('--port', type=int, default=0); parser.add_argument('--seed', type=int, default=None)
    parser.add_argument('--user'); parser.add_argument('--token'); parser.add_argument('--tls', nargs=2)
    for flag in ('no-authenticate', 'seven', 'two-processes', 'will-not-sit', 'two-rounds', 'capability-first', 'odd-messages'): parser.add_argument('--' + flag, action='store_true')
    parser.add_argument('--ghost'); parser.add_argument('--without', nargs='*', default=[]); parser.add_argument('--posture', default='Sit')
    options = parser.parse_args()
    robot, connections = Robot(options), []
    robot.posture = options.posture
    listeners = []
    for wanted in (options.port, 0):
        listener = socket.socket(); listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(('127.0.0.1', wanted)); listener.listen(16); listeners.append(listener)
    options.second_port = listeners[1].getsockname()[1]
    for listener in listeners: threading.Thread(target=serve, args=(robot, listener, listener.getsockname()[1], connections), daemon=True).start()
    log({'listening': listeners[0].getsockname()[1]})
    for line in sys.stdin:
        words = line.split()
        if words[0] == 'hang': robot.hanging.add(words[1])
        if words[0] == 'fail': robot.failing.add(words[1])
        if words[0] == 'ok': robot.hanging.discard(words[1]); robot.failing.discard(words[1])
        if words[0] == 'freeze': robot.frozen = True
        if words[0] == 'cut':
            for connection in connections:
                connection.send(header(1, 5000, 2, 1, 1, 2) + b'half')
        if words[0] in ('cut', 'drop'):
            robot.links.clear()
            for connection in connections:
                try: connection.stream.shutdown(socket.SHUT_RDWR)
                except OSError: pass
            connections.clear()
        if words[0] == 'touch':
            for connection, service, number, signal in robot.links:
                if robot.subscribers.get(number) != 'FrontTactilTouched': continue
                payload = dynamic('f', struct.pack('<f', float(words[1])))
                connection.send(header(9, len(payload), 5, service, number, signal) + payload)

main()
