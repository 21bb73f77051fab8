"""Measure the microfiber-sheen LTC table (Zeltner, Burley, Chiang 2022) that Cycles uses.

    target/test-venv/bin/python benches/cycles/sheen_table.py      # a minute on one thread, with bpy 5.0.1

Writes src/bsdf/sheen.bin: little-endian f32, A[32][32], then B[32][32], then R[32][32];
outer index roughness j/31, inner index cos(N, wo) i/31. Read it bilinearly (what Cycles does), with
roughness clamped to [1e-3, 1]; a lobe with |A| < 1e-5 or R < 1e-5 is skipped by Cycles.

Model (closure/bsdf_sheen.h), local frame z = N, x = the tangential part of wo (so wo.x >= 0):

    f cos(wi) = R/pi * max(wi.z, 0) * (A / len2)^2
    len2 = (A wi.x + B wi.z)^2 + (A wi.y)^2 + wi.z^2

Method: one pixel per (roughness, cos) node and half node, a tilted quad under an ortho camera, so
wo is the same everywhere and exact; no world; sun of angle 0 (a delta light: no noise), no shadow,
0 bounces; one render per sun direction. radiance = (f cos) * E, with E calibrated by a Lambert sheet.
q = sqrt(wi.z / (pi f)) = len2 / (A sqrt R) is linear in p1 = A/sqrtR, p2 = 2B/sqrtR,
p3 = (B^2+1)/(A sqrtR):  q = p1 (x^2+y^2) + p2 x z + p3 z^2,  R = 1/(p1 p3 - p2^2/4).
Least squares over all directions above the horizon, relative weights.
The cos-0 column can't be seen: it is 2 * value(half node 0.5/31) - value(node 1), exact because
Cycles interpolates linearly; roughness row 0 likewise is extrapolated from roughness 1e-3.
"""
import math
from pathlib import Path

import bpy
import numpy as np

from lab import light, mesh, orthographic_camera, render, reset, towards

TABLE = Path(__file__).resolve().parents[2] / "src" / "bsdf" / "sheen.bin"
KC = 62                                   # cos = k / 62, k = 1..62
ROUGH = np.array([1e-3] + [k / 62 for k in range(1, 63)])   # row 0 is the clamp
COS = np.arange(1, KC + 1) / KC
NX, NY = len(COS), len(ROUGH)
W, H = 2 * NX, 2 * NY


def build(sheen):
    s = reset((W, H), 1)
    s.cycles.max_bounces = 0
    verts, faces, vals = [], [], []
    for j in range(NY):
        for i in range(NX):
            c = COS[i]; sn = math.sqrt(1 - c * c)
            cx, cy = 2 * i + 1 - W / 2 - .5, 2 * j + 1 - H / 2 - .5
            h = .6; dz = -h * sn / c           # normal (sn, 0, c)
            n = len(verts)
            verts += [(cx - h, cy - h, -dz), (cx + h, cy - h, dz), (cx + h, cy + h, dz), (cx - h, cy + h, -dz)]
            faces.append((n, n + 1, n + 2, n + 3)); vals.append(ROUGH[j])
    m = bpy.data.materials.new('m'); nt = m.node_tree
    for x in list(nt.nodes): nt.nodes.remove(x)
    o = nt.nodes.new('ShaderNodeOutputMaterial')
    if sheen:
        b = nt.nodes.new('ShaderNodeBsdfSheen'); b.distribution = 'MICROFIBER'
        a = nt.nodes.new('ShaderNodeAttribute'); a.attribute_name = 'rough'
        nt.links.new(a.outputs['Fac'], b.inputs['Roughness'])
        b.inputs['Color'].default_value = (1, 1, 1, 1)
    else:
        b = nt.nodes.new('ShaderNodeBsdfDiffuse'); b.inputs['Color'].default_value = (1, 1, 1, 1)
        b.inputs['Roughness'].default_value = 0
    nt.links.new(b.outputs[0], o.inputs['Surface'])
    ob = mesh('g', verts, faces, m)
    at = ob.data.attributes.new('rough', 'FLOAT', 'FACE'); at.data.foreach_set('value', np.array(vals, 'f'))
    orthographic_camera((0, 0, 200), max(W, H))
    return light('SUN', energy=1.0, angle=0.0, use_shadow=False)


def shoot(sun, d):
    z = towards(sun, d)
    im = render()['ViewLayer.Combined.R'][::-1]           # row 0 at the bottom
    # pixel centres of quads: (2i+1-.5 , 2j+1-.5) -> pixel index 2i
    return z, im[0::2, 0::2].astype(float)


def dirs():
    out = []
    for el in (75, 50, 25, 8):
        for az in (0, 50, 100, 180) if el != 75 else (0, 180):
            e, a = math.radians(el), math.radians(az)
            out.append((math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)))
    for el in (-20, -50, -75):                # reach the tilted quads from below the camera's horizon
        for az in (0, 60):
            e, a = math.radians(el), math.radians(az)
            out.append((math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)))
    return out


def main():
    D = dirs()
    Nv = np.stack([np.sqrt(1 - COS**2), 0 * COS, COS], -1)
    V = np.array([0, 0, 1.0])
    T = V - Nv * COS[:, None]; ln = np.linalg.norm(T, axis=1)
    T[ln > 1e-6] /= ln[ln > 1e-6, None]; T[ln <= 1e-6] = (2**-.5, -2**-.5, 0)   # Cycles' make_orthonormals fallback at cos 1
    Bv = np.cross(Nv, T)
    sun = build(False)
    cal = []
    for d in D[:4]:
        z, im = shoot(sun, d); ndl = np.clip(Nv @ z, 0, None); ok = ndl > .1
        cal.append((im[:, ok] * math.pi / ndl[ok]).ravel())
    cal = np.concatenate(cal); E = float(np.median(cal))
    print('E', E, 'spread', cal.min() - E, cal.max() - E)
    sun = build(True)
    F, X = [], []
    for d in D:
        z, im = shoot(sun, d); F.append(im / E); X.append(np.stack([T @ z, Bv @ z, Nv @ z], -1))
    F, X = np.array(F), np.array(X)            # [dir, rough, cos], [dir, cos, 3]
    A = np.full((NY, NX), np.nan); B = A.copy(); R = A.copy(); res = A.copy(); nd = np.zeros((NY, NX), int)
    for j in range(NY):
        for i in range(NX):
            x = X[:, i]; f = F[:, j, i]
            ok = (x[:, 2] > .03) & (f > 1e-30)
            nd[j, i] = ok.sum()
            if ok.sum() < 4: continue
            x, f = x[ok], f[ok]
            q = np.sqrt(x[:, 2] / (math.pi * f))
            M = np.stack([x[:, 0]**2 + x[:, 1]**2, x[:, 0] * x[:, 2], x[:, 2]**2], -1)
            p, *_ = np.linalg.lstsq(M / q[:, None], np.ones(len(q)), rcond=None)
            den = p[0] * p[2] - p[1]**2 / 4
            if den <= 0: continue
            R[j, i] = 1 / den; s = math.sqrt(R[j, i]); A[j, i] = p[0] * s; B[j, i] = p[1] * s / 2
            res[j, i] = np.abs((M @ p / q)**2 - 1).max()      # relative residual of f
    print('nodes fitted', np.isfinite(R).sum(), 'of', R.size, ' max rel residual of f', np.nanmax(res), 'median', np.nanmedian(res))
    tab = {}
    for n, v in (('A', A), ('B', B), ('R', R)):
        # half nodes must be the mean of their neighbours, where all three exist
        o = np.abs(v[2::2, 2:-1:2] - .5 * (v[2::2, 1:-2:2] + v[2::2, 3::2]))
        o2 = np.abs(v[3:-1:2, 1::2] - .5 * (v[2:-2:2, 1::2] + v[4::2, 1::2]))
        print(n, 'linearity along cos', np.nanmax(o), 'along roughness', np.nanmax(o2))
        c0 = 2 * v[:, 0] - v[:, 1]                                # cos 0
        full = np.concatenate([c0[:, None], v], 1)                # half nodes, cos k/62, k = 0..62
        t = .031                                                  # rough 1e-3 = .031 of the way 0 -> 1
        full[0] = (full[0] - t * full[2]) / (1 - t)
        tab[n] = (full[0::2, 0::2], full)
    # A node Cycles skips (R or |A| < 1e-5) still acts through interpolation up to its visible
    # neighbours: infer it from a visible half node, else it is 0.
    inferred = 0
    for n in 'ABR':
        v, full = tab[n]
        for j in range(32):
            for i in range(32):
                if np.isnan(v[j, i]):
                    c = [2 * full[2*j, 2*i - 1] - full[2*j, 2*i - 2]] if i else []
                    c += [2 * full[2*j + 1, 2*i] - full[2*j + 2, 2*i]] if j < 31 else []
                    c = [x for x in c if np.isfinite(x)]
                    if c: v[j, i] = c[-1]; inferred += n == 'R'; print('inferred', n, j, i, c)
        tab[n] = v
    for n in 'ABR':
        v = tab[n]; e = np.abs(v - np.round(v, 5)); print(n, 'nan', int(np.isnan(v).sum()), 'range', np.nanmin(v), np.nanmax(v),
            'distance to 5 decimals: max', np.nanmax(e), '99%', np.nanquantile(e, .99), 'median', np.nanmedian(e))
        bad = np.argwhere(e > 1.5e-6); print('   nodes off 5 decimals:', len(bad), [(int(j), int(i), float(v[j, i])) for j, i in bad[:12]])
    # The table that Cycles holds has 5 decimals (99% of A, R within 1.4e-6 of one): round to it.
    np.concatenate([(np.round(np.nan_to_num(tab[n]), 5) + 0.0).ravel() for n in 'ABR']).astype('<f4').tofile(TABLE)
    check()


def model(A, B, R, x):
    len2 = (A * x[..., 0] + B * x[..., 2])**2 + (A * x[..., 1])**2 + x[..., 2]**2
    return R / math.pi * np.maximum(x[..., 2], 0) * (A / len2)**2


def read(T, c, r):
    u, v = c * 31, np.clip(r, 1e-3, 1) * 31
    i, j = np.minimum(u.astype(int), 30), np.minimum(v.astype(int), 30); s, t = u - i, v - j
    return (T[:, j, i] * (1 - s) + T[:, j, i + 1] * s) * (1 - t) + (T[:, j + 1, i] * (1 - s) + T[:, j + 1, i + 1] * s) * t


def check():
    """The written table against Cycles at random roughness, view angle and light direction."""
    global COS, ROUGH, NX, NY, W, H
    g = np.random.default_rng(7)
    COS = np.sort(g.uniform(.02, 1, NX)); ROUGH = np.sort(g.uniform(.04, 1, NY))
    T3 = np.fromfile(TABLE, '<f4').reshape(3, 32, 32).astype(float)
    cc, rr = np.broadcast_arrays(COS[None, :], ROUGH[:, None])
    A, B, R = read(T3, cc, rr)
    Nv = np.stack([np.sqrt(1 - COS**2), 0 * COS, COS], -1)
    T = np.array([0, 0, 1.0]) - Nv * COS[:, None]; T /= np.linalg.norm(T, axis=1)[:, None]; Bv = np.cross(Nv, T)
    sun = build(True); E = []; P = []
    for d in g.normal(size=(8, 3)):
        z, im = shoot(sun, d); x = np.stack([T @ z, Bv @ z, Nv @ z], -1)
        p = model(A, B, R, x[None]); p[(R < 1e-5) | (np.abs(A) < 1e-5)] = 0
        E.append(im - p); P.append(p)
    E, P = np.array(E), np.array(P); ok = P > 1e-4
    rel = np.abs(E[ok] / P[ok])
    print('check: f cos, %d pairs above 1e-4: relative error max %.2e 99%% %.2e median %.2e; absolute error max %.2e (f cos max %.3f)'
          % (ok.sum(), rel.max(), np.quantile(rel, .99), np.median(rel), np.abs(E).max(), P.max()))
    for r in (.5, 1.0):
        c = np.cos(np.radians([0, 45, 60, 75, 85])); print('R rough', r, 'at 0/45/60/75/85:', np.round(read(T3, c, np.full(5, r))[2], 4))


if __name__ == '__main__':
    main()
