// A NumPy archive, read by Python alone and held against the same table as CSV.
#pragma once

/// python3 read.py ARCHIVE.npz TABLE.csv: an archive is a ZIP file of arrays whose headers Python can
/// evaluate.
inline constexpr const char* kReadArchive = R"(
import ast, struct, sys, zipfile
archive = zipfile.ZipFile(sys.argv[1])
assert archive.testzip() is None
def array(name):
    data = archive.read(name + '.npy')
    assert data[:8] == b'\x93NUMPY\x01\x00'
    size = struct.unpack('<H', data[8:10])[0]
    assert (10 + size) % 64 == 0
    header, body = ast.literal_eval(data[10:10 + size].decode()), data[10 + size:]
    count, kind = header['shape'][0], header['descr']
    if kind[1] == 'S':
        width = int(kind[2:])
        return [body[i * width:(i + 1) * width].rstrip(b'\0').decode() for i in range(count)]
    return struct.unpack('<%d%s' % (count, 'd' if kind == '<f8' else 'Q'), body)
columns, units = array('columns'), array('units')
assert len(columns) == len(units) == len(archive.namelist()) - 2
rows = [line.rstrip('\n').split(',') for line in open(sys.argv[2])]
assert len(columns) == len(rows[0])
for i, (name, unit) in enumerate(zip(columns, units)):
    assert rows[0][i] == name + (' [%s]' % unit if unit else ''), rows[0][i]
    values = array(name)
    assert len(values) == len(rows) - 1
    for row, value in zip(rows[1:], values):
        if isinstance(value, str):
            assert row[i] == value, (name, row[i], value)
        else:
            assert abs(float(row[i]) - value) <= 1e-5 * abs(value), (name, row[i], value)
)";
