% Four-bar linkage with clearance in the joint of crank and coupler: the paper's case a, as one
% writes it in an afternoon, for Octave; MATLAB takes functions at this place from R2024a on.
%
%   octave-cli four_bar_a.m          writes four_bar_a.csv
%
% Absolute coordinates of coupler (3) and follower (4), ideal joints B and B0 by multipliers, the
% crank as a known function of time, Lankarani-Nikravesh contact, ode15s with events.
1;

function [F, d, dn, e] = contact(t, y, p)
  % force on the journal (N), penetration (m), its rate (m/s), journal minus bearing (m)
  phi = p.w*t;
  bearing  = p.l2*[cos(phi); sin(phi)];
  dbearing = p.w*p.l2*[-sin(phi); cos(phi)];
  journal  = y(1:2) - p.l3/2*[cos(y(3)); sin(y(3))];
  djournal = y(7:8) - p.l3/2*y(9)*[-sin(y(3)); cos(y(3))];
  e = journal - bearing;
  n = e/max(norm(e), 1e-12);
  d = norm(e) - p.c;
  dn = n'*(djournal - dbearing);
  F = [0; 0];
  if p.touching && d > 0
    F = -p.K*d^1.5*(1 + 0.75*(1 - p.ce^2)*dn/p.v0)*n;
  end
end

function dy = four_bar(t, y, p)
  F = contact(t, y, p);
  a3 = p.l3/2*[cos(y(3)); sin(y(3))];           % mass centre to B; to A it is -a3
  a4 = p.l4/2*[cos(y(6)); sin(y(6))];           % mass centre to B; to B0 it is -a4
  turn = @(s) [-s(2); s(1)];
  M = diag([p.m3 p.m3 p.J3 p.m4 p.m4 p.J4]);
  Phi_q = [eye(2)      turn(a3)    -eye(2)  -turn(a4);
           zeros(2,3)               eye(2)  -turn(a4)];
  gamma = [y(9)^2*a3 - y(12)^2*a4; -y(12)^2*a4];
  Q = [F; -a3(1)*F(2) + a3(2)*F(1); 0; 0; 0];
  x = [M Phi_q'; Phi_q zeros(4)] \ [Q; gamma];
  dy = [y(7:12); x(1:6)];
end

function [value, isterminal, direction] = touch(t, y, p)
  [~, d] = contact(t, y, p);
  value = d;
  isterminal = 1;
  direction = 1 - 2*p.touching;
end

p.l2 = 0.03; p.l3 = 0.18; p.l4 = 0.12; ground = 0.2;             % m
p.m3 = 0.0737; p.J3 = 2.02e-4; p.m4 = 0.049; p.J4 = 6.19e-5;     % kg, kg m^2
p.w = 5000*2*pi/60;                                              % rad/s
p.c = 1e-3; Rb = 0.01; Rj = Rb - p.c; p.ce = 0.9;                % m
sigma = (1 - 0.3^2)/207e9;
p.K = 4/(3*2*sigma)*sqrt(Rb*Rj/(Rb + Rj));                       % N/m^1.5
p.touching = false; p.v0 = 1;

% start: the ideal mechanism at crank angle 0
A = [p.l2; 0]; B0 = [ground; 0];
dist = norm(B0 - A);
alpha = acos((p.l3^2 + dist^2 - p.l4^2)/(2*p.l3*dist));
B = A + p.l3*[cos(alpha); sin(alpha)];
th3 = alpha; th4 = atan2(B(2) - B0(2), B(1) - B0(1));
w34 = [-p.l3*sin(th3) p.l4*sin(th4); p.l3*cos(th3) -p.l4*cos(th4)] \ [0; -p.w*p.l2];
w3 = w34(1); w4 = w34(2);
v3 = [0; p.w*p.l2] + w3*p.l3/2*[-sin(th3); cos(th3)];
v4 = w4*p.l4/2*[-sin(th4); cos(th4)];
y = [(A + B)/2; th3; (B + B0)/2; th4; v3; w3; v4; w4];

% from one contact change to the next
t = 0; t_end = 2e-3;
T = t; Y = y';
while t < t_end
  options = odeset('RelTol', 1e-10, 'AbsTol', 1e-14, 'InitialStep', 1e-10, ...
                   'Events', @(t, y) touch(t, y, p));
  [ts, ys, te] = ode15s(@(t, y) four_bar(t, y, p), [t t_end], y, options);
  T = [T; ts(2:end)]; Y = [Y; ys(2:end,:)];
  t = ts(end); y = ys(end,:)';
  if ~isempty(te) && t < t_end
    p.touching = ~p.touching;
    [~, ~, dn] = contact(t, y, p);
    if p.touching, p.v0 = dn; end
  end
end

% the clearance vector at every sample
E = zeros(numel(T), 2);
for k = 1:numel(T)
  [~, ~, ~, e] = contact(T(k), Y(k,:)', p);
  E(k,:) = e';
end

file = fopen('four_bar_a.csv', 'w');
fprintf(file, 't,x3,y3,theta3,x4,y4,theta4,vx3,vy3,omega3,vx4,vy4,omega4,ex,ey\n');
fprintf(file, [repmat('%.17g,', 1, 14) '%.17g\n'], [T Y E]');
fclose(file);
