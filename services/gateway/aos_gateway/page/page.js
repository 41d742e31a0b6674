var Je,x,tn,Ze,ae,Xt,nn,sn,on,xt,yt,wt,xs,Ee={},rn=[],ks=/acit|ex(?:s|g|n|p|$)|rph|grid|ows|mnc|ntw|ine[ch]|zoo|^ord|itera/i,Xe=Array.isArray;function ee(e,t){for(var n in t)e[n]=t[n];return e}function kt(e){e&&e.parentNode&&e.parentNode.removeChild(e)}function Qe(e,t,n){var s,o,i,r={};for(i in t)i=="key"?s=t[i]:i=="ref"?o=t[i]:r[i]=t[i];if(arguments.length>2&&(r.children=arguments.length>3?Je.call(arguments,2):n),typeof e=="function"&&e.defaultProps!=null)for(i in e.defaultProps)r[i]===void 0&&(r[i]=e.defaultProps[i]);return Ge(e,r,s,o,null)}function Ge(e,t,n,s,o){var i={type:e,props:t,key:n,ref:s,__k:null,__:null,__b:0,__e:null,__c:null,constructor:void 0,__v:o??++tn,__i:-1,__u:0};return o==null&&x.vnode!=null&&x.vnode(i),i}function Ye(e){return e.children}function le(e,t){this.props=e,this.context=t}function ge(e,t){if(t==null)return e.__?ge(e.__,e.__i+1):null;for(var n;t<e.__k.length;t++)if((n=e.__k[t])!=null&&n.__e!=null)return n.__e;return typeof e.type=="function"?ge(e):null}function an(e){var t,n;if((e=e.__)!=null&&e.__c!=null){for(e.__e=e.__c.base=null,t=0;t<e.__k.length;t++)if((n=e.__k[t])!=null&&n.__e!=null){e.__e=e.__c.base=n.__e;break}return an(e)}}function Qt(e){(!e.__d&&(e.__d=!0)&&ae.push(e)&&!Ke.__r++||Xt!=x.debounceRendering)&&((Xt=x.debounceRendering)||nn)(Ke)}function Ke(){for(var e,t,n,s,o,i,r,c=1;ae.length;)ae.length>c&&ae.sort(sn),e=ae.shift(),c=ae.length,e.__d&&(n=void 0,o=(s=(t=e).__v).__e,i=[],r=[],t.__P&&((n=ee({},s)).__v=s.__v+1,x.vnode&&x.vnode(n),St(t.__P,n,s,t.__n,t.__P.namespaceURI,32&s.__u?[o]:null,i,o??ge(s),!!(32&s.__u),r),n.__v=s.__v,n.__.__k[n.__i]=n,un(i,n,r),n.__e!=o&&an(n)));Ke.__r=0}function ln(e,t,n,s,o,i,r,c,d,l,p){var u,f,h,v,m,_,b=s&&s.__k||rn,y=t.length;for(d=Ss(n,t,b,d,y),u=0;u<y;u++)(h=n.__k[u])!=null&&(f=h.__i==-1?Ee:b[h.__i]||Ee,h.__i=u,_=St(e,h,f,o,i,r,c,d,l,p),v=h.__e,h.ref&&f.ref!=h.ref&&(f.ref&&Ct(f.ref,null,h),p.push(h.ref,h.__c||v,h)),m==null&&v!=null&&(m=v),4&h.__u||f.__k===h.__k?d=cn(h,d,e):typeof h.type=="function"&&_!==void 0?d=_:v&&(d=v.nextSibling),h.__u&=-7);return n.__e=m,d}function Ss(e,t,n,s,o){var i,r,c,d,l,p=n.length,u=p,f=0;for(e.__k=new Array(o),i=0;i<o;i++)(r=t[i])!=null&&typeof r!="boolean"&&typeof r!="function"?(d=i+f,(r=e.__k[i]=typeof r=="string"||typeof r=="number"||typeof r=="bigint"||r.constructor==String?Ge(null,r,null,null,null):Xe(r)?Ge(Ye,{children:r},null,null,null):r.constructor==null&&r.__b>0?Ge(r.type,r.props,r.key,r.ref?r.ref:null,r.__v):r).__=e,r.__b=e.__b+1,c=null,(l=r.__i=Cs(r,n,d,u))!=-1&&(u--,(c=n[l])&&(c.__u|=2)),c==null||c.__v==null?(l==-1&&(o>p?f--:o<p&&f++),typeof r.type!="function"&&(r.__u|=4)):l!=d&&(l==d-1?f--:l==d+1?f++:(l>d?f--:f++,r.__u|=4))):e.__k[i]=null;if(u)for(i=0;i<p;i++)(c=n[i])!=null&&(2&c.__u)==0&&(c.__e==s&&(s=ge(c)),pn(c,c));return s}function cn(e,t,n){var s,o;if(typeof e.type=="function"){for(s=e.__k,o=0;s&&o<s.length;o++)s[o]&&(s[o].__=e,t=cn(s[o],t,n));return t}e.__e!=t&&(t&&e.type&&!n.contains(t)&&(t=ge(e)),n.insertBefore(e.__e,t||null),t=e.__e);do t=t&&t.nextSibling;while(t!=null&&t.nodeType==8);return t}function Cs(e,t,n,s){var o,i,r=e.key,c=e.type,d=t[n];if(d===null&&e.key==null||d&&r==d.key&&c==d.type&&(2&d.__u)==0)return n;if(s>(d!=null&&(2&d.__u)==0?1:0))for(o=n-1,i=n+1;o>=0||i<t.length;){if(o>=0){if((d=t[o])&&(2&d.__u)==0&&r==d.key&&c==d.type)return o;o--}if(i<t.length){if((d=t[i])&&(2&d.__u)==0&&r==d.key&&c==d.type)return i;i++}}return-1}function Yt(e,t,n){t[0]=="-"?e.setProperty(t,n??""):e[t]=n==null?"":typeof n!="number"||ks.test(t)?n:n+"px"}function Ve(e,t,n,s,o){var i,r;e:if(t=="style")if(typeof n=="string")e.style.cssText=n;else{if(typeof s=="string"&&(e.style.cssText=s=""),s)for(t in s)n&&t in n||Yt(e.style,t,"");if(n)for(t in n)s&&n[t]==s[t]||Yt(e.style,t,n[t])}else if(t[0]=="o"&&t[1]=="n")i=t!=(t=t.replace(on,"$1")),r=t.toLowerCase(),t=r in e||t=="onFocusOut"||t=="onFocusIn"?r.slice(2):t.slice(2),e.l||(e.l={}),e.l[t+i]=n,n?s?n.u=s.u:(n.u=xt,e.addEventListener(t,i?wt:yt,i)):e.removeEventListener(t,i?wt:yt,i);else{if(o=="http://www.w3.org/2000/svg")t=t.replace(/xlink(H|:h)/,"h").replace(/sName$/,"s");else if(t!="width"&&t!="height"&&t!="href"&&t!="list"&&t!="form"&&t!="tabIndex"&&t!="download"&&t!="rowSpan"&&t!="colSpan"&&t!="role"&&t!="popover"&&t in e)try{e[t]=n??"";break e}catch{}typeof n=="function"||(n==null||n===!1&&t[4]!="-"?e.removeAttribute(t):e.setAttribute(t,t=="popover"&&n==1?"":n))}}function en(e){return function(t){if(this.l){var n=this.l[t.type+e];if(t.t==null)t.t=xt++;else if(t.t<n.u)return;return n(x.event?x.event(t):t)}}}function St(e,t,n,s,o,i,r,c,d,l){var p,u,f,h,v,m,_,b,y,Se,oe,qe,Ce,Zt,Be,Me,bt,G=t.type;if(t.constructor!=null)return null;128&n.__u&&(d=!!(32&n.__u),i=[c=t.__e=n.__e]),(p=x.__b)&&p(t);e:if(typeof G=="function")try{if(b=t.props,y="prototype"in G&&G.prototype.render,Se=(p=G.contextType)&&s[p.__c],oe=p?Se?Se.props.value:p.__:s,n.__c?_=(u=t.__c=n.__c).__=u.__E:(y?t.__c=u=new G(b,oe):(t.__c=u=new le(b,oe),u.constructor=G,u.render=Ts),Se&&Se.sub(u),u.props=b,u.state||(u.state={}),u.context=oe,u.__n=s,f=u.__d=!0,u.__h=[],u._sb=[]),y&&u.__s==null&&(u.__s=u.state),y&&G.getDerivedStateFromProps!=null&&(u.__s==u.state&&(u.__s=ee({},u.__s)),ee(u.__s,G.getDerivedStateFromProps(b,u.__s))),h=u.props,v=u.state,u.__v=t,f)y&&G.getDerivedStateFromProps==null&&u.componentWillMount!=null&&u.componentWillMount(),y&&u.componentDidMount!=null&&u.__h.push(u.componentDidMount);else{if(y&&G.getDerivedStateFromProps==null&&b!==h&&u.componentWillReceiveProps!=null&&u.componentWillReceiveProps(b,oe),!u.__e&&u.shouldComponentUpdate!=null&&u.shouldComponentUpdate(b,u.__s,oe)===!1||t.__v==n.__v){for(t.__v!=n.__v&&(u.props=b,u.state=u.__s,u.__d=!1),t.__e=n.__e,t.__k=n.__k,t.__k.some(function(Te){Te&&(Te.__=t)}),qe=0;qe<u._sb.length;qe++)u.__h.push(u._sb[qe]);u._sb=[],u.__h.length&&r.push(u);break e}u.componentWillUpdate!=null&&u.componentWillUpdate(b,u.__s,oe),y&&u.componentDidUpdate!=null&&u.__h.push(function(){u.componentDidUpdate(h,v,m)})}if(u.context=oe,u.props=b,u.__P=e,u.__e=!1,Ce=x.__r,Zt=0,y){for(u.state=u.__s,u.__d=!1,Ce&&Ce(t),p=u.render(u.props,u.state,u.context),Be=0;Be<u._sb.length;Be++)u.__h.push(u._sb[Be]);u._sb=[]}else do u.__d=!1,Ce&&Ce(t),p=u.render(u.props,u.state,u.context),u.state=u.__s;while(u.__d&&++Zt<25);u.state=u.__s,u.getChildContext!=null&&(s=ee(ee({},s),u.getChildContext())),y&&!f&&u.getSnapshotBeforeUpdate!=null&&(m=u.getSnapshotBeforeUpdate(h,v)),Me=p,p!=null&&p.type===Ye&&p.key==null&&(Me=dn(p.props.children)),c=ln(e,Xe(Me)?Me:[Me],t,n,s,o,i,r,c,d,l),u.base=t.__e,t.__u&=-161,u.__h.length&&r.push(u),_&&(u.__E=u.__=null)}catch(Te){if(t.__v=null,d||i!=null)if(Te.then){for(t.__u|=d?160:128;c&&c.nodeType==8&&c.nextSibling;)c=c.nextSibling;i[i.indexOf(c)]=null,t.__e=c}else for(bt=i.length;bt--;)kt(i[bt]);else t.__e=n.__e,t.__k=n.__k;x.__e(Te,t,n)}else i==null&&t.__v==n.__v?(t.__k=n.__k,t.__e=n.__e):c=t.__e=Ms(n.__e,t,n,s,o,i,r,d,l);return(p=x.diffed)&&p(t),128&t.__u?void 0:c}function un(e,t,n){for(var s=0;s<n.length;s++)Ct(n[s],n[++s],n[++s]);x.__c&&x.__c(t,e),e.some(function(o){try{e=o.__h,o.__h=[],e.some(function(i){i.call(o)})}catch(i){x.__e(i,o.__v)}})}function dn(e){return typeof e!="object"||e==null||e.__b&&e.__b>0?e:Xe(e)?e.map(dn):ee({},e)}function Ms(e,t,n,s,o,i,r,c,d){var l,p,u,f,h,v,m,_=n.props,b=t.props,y=t.type;if(y=="svg"?o="http://www.w3.org/2000/svg":y=="math"?o="http://www.w3.org/1998/Math/MathML":o||(o="http://www.w3.org/1999/xhtml"),i!=null){for(l=0;l<i.length;l++)if((h=i[l])&&"setAttribute"in h==!!y&&(y?h.localName==y:h.nodeType==3)){e=h,i[l]=null;break}}if(e==null){if(y==null)return document.createTextNode(b);e=document.createElementNS(o,y,b.is&&b),c&&(x.__m&&x.__m(t,i),c=!1),i=null}if(y==null)_===b||c&&e.data==b||(e.data=b);else{if(i=i&&Je.call(e.childNodes),_=n.props||Ee,!c&&i!=null)for(_={},l=0;l<e.attributes.length;l++)_[(h=e.attributes[l]).name]=h.value;for(l in _)if(h=_[l],l!="children"){if(l=="dangerouslySetInnerHTML")u=h;else if(!(l in b)){if(l=="value"&&"defaultValue"in b||l=="checked"&&"defaultChecked"in b)continue;Ve(e,l,null,h,o)}}for(l in b)h=b[l],l=="children"?f=h:l=="dangerouslySetInnerHTML"?p=h:l=="value"?v=h:l=="checked"?m=h:c&&typeof h!="function"||_[l]===h||Ve(e,l,h,_[l],o);if(p)c||u&&(p.__html==u.__html||p.__html==e.innerHTML)||(e.innerHTML=p.__html),t.__k=[];else if(u&&(e.innerHTML=""),ln(t.type=="template"?e.content:e,Xe(f)?f:[f],t,n,s,y=="foreignObject"?"http://www.w3.org/1999/xhtml":o,i,r,i?i[0]:n.__k&&ge(n,0),c,d),i!=null)for(l=i.length;l--;)kt(i[l]);c||(l="value",y=="progress"&&v==null?e.removeAttribute("value"):v!=null&&(v!==e[l]||y=="progress"&&!v||y=="option"&&v!=_[l])&&Ve(e,l,v,_[l],o),l="checked",m!=null&&m!=e[l]&&Ve(e,l,m,_[l],o))}return e}function Ct(e,t,n){try{if(typeof e=="function"){var s=typeof e.__u=="function";s&&e.__u(),s&&t==null||(e.__u=e(t))}else e.current=t}catch(o){x.__e(o,n)}}function pn(e,t,n){var s,o;if(x.unmount&&x.unmount(e),(s=e.ref)&&(s.current&&s.current!=e.__e||Ct(s,null,t)),(s=e.__c)!=null){if(s.componentWillUnmount)try{s.componentWillUnmount()}catch(i){x.__e(i,t)}s.base=s.__P=null}if(s=e.__k)for(o=0;o<s.length;o++)s[o]&&pn(s[o],t,n||typeof e.type!="function");n||kt(e.__e),e.__c=e.__=e.__e=void 0}function Ts(e,t,n){return this.constructor(e,n)}function Mt(e,t,n){var s,o,i,r;t==document&&(t=document.documentElement),x.__&&x.__(e,t),o=(s=typeof n=="function")?null:n&&n.__k||t.__k,i=[],r=[],St(t,e=(!s&&n||t).__k=Qe(Ye,null,[e]),o||Ee,Ee,t.namespaceURI,!s&&n?[n]:o?null:t.firstChild?Je.call(t.childNodes):null,i,!s&&n?n:o?o.__e:t.firstChild,s,r),un(i,e,r)}Je=rn.slice,x={__e:function(e,t,n,s){for(var o,i,r;t=t.__;)if((o=t.__c)&&!o.__)try{if((i=o.constructor)&&i.getDerivedStateFromError!=null&&(o.setState(i.getDerivedStateFromError(e)),r=o.__d),o.componentDidCatch!=null&&(o.componentDidCatch(e,s||{}),r=o.__d),r)return o.__E=o}catch(c){e=c}throw e}},tn=0,Ze=function(e){return e!=null&&e.constructor==null},le.prototype.setState=function(e,t){var n;n=this.__s!=null&&this.__s!=this.state?this.__s:this.__s=ee({},this.state),typeof e=="function"&&(e=e(ee({},n),this.props)),e&&ee(n,e),e!=null&&this.__v&&(t&&this._sb.push(t),Qt(this))},le.prototype.forceUpdate=function(e){this.__v&&(this.__e=!0,e&&this.__h.push(e),Qt(this))},le.prototype.render=Ye,ae=[],nn=typeof Promise=="function"?Promise.prototype.then.bind(Promise.resolve()):setTimeout,sn=function(e,t){return e.__v.__b-t.__v.__b},Ke.__r=0,on=/(PointerCapture)$|Capture$/i,xt=0,yt=en(!1),wt=en(!0),xs=0;var hn=function(e,t,n,s){var o;t[0]=0;for(var i=1;i<t.length;i++){var r=t[i++],c=t[i]?(t[0]|=r?1:2,n[t[i++]]):t[++i];r===3?s[0]=c:r===4?s[1]=Object.assign(s[1]||{},c):r===5?(s[1]=s[1]||{})[t[++i]]=c:r===6?s[1][t[++i]]+=c+"":r?(o=e.apply(c,hn(e,c,n,["",null])),s.push(o),c[0]?t[0]|=2:(t[i-2]=0,t[i]=o)):s.push(c)}return s},fn=new Map;function mn(e){var t=fn.get(this);return t||(t=new Map,fn.set(this,t)),(t=hn(this,t.get(e)||(t.set(e,t=function(n){for(var s,o,i=1,r="",c="",d=[0],l=function(f){i===1&&(f||(r=r.replace(/^\s*\n\s*|\s*\n\s*$/g,"")))?d.push(0,f,r):i===3&&(f||r)?(d.push(3,f,r),i=2):i===2&&r==="..."&&f?d.push(4,f,0):i===2&&r&&!f?d.push(5,0,!0,r):i>=5&&((r||!f&&i===5)&&(d.push(i,0,r,o),i=6),f&&(d.push(i,f,0,o),i=6)),r=""},p=0;p<n.length;p++){p&&(i===1&&l(),l(p));for(var u=0;u<n[p].length;u++)s=n[p][u],i===1?s==="<"?(l(),d=[d],i=3):r+=s:i===4?r==="--"&&s===">"?(i=1,r=""):r=s+r[0]:c?s===c?c="":r+=s:s==='"'||s==="'"?c=s:s===">"?(l(),i=1):i&&(s==="="?(i=5,o=r,r=""):s==="/"&&(i<5||n[p][u+1]===">")?(l(),i===3&&(d=d[0]),i=d,(d=d[0]).push(2,0,i),i=0):s===" "||s==="	"||s===`
`||s==="\r"?(l(),i=2):r+=s),i===3&&r==="!--"&&(i=4,d=d[0])}return l(),d}(e)),t),arguments,[])).length>1?t:t[0]}var a=mn.bind(Qe);var Oe,N,Tt,vn,tt=0,kn=[],I=x,_n=I.__b,$n=I.__r,gn=I.diffed,bn=I.__c,yn=I.unmount,wn=I.__;function Ot(e,t){I.__h&&I.__h(N,e,tt||t),tt=0;var n=N.__H||(N.__H={__:[],__h:[]});return e>=n.__.length&&n.__.push({}),n.__[e]}function $(e){return tt=1,Es(Cn,e)}function Es(e,t,n){var s=Ot(Oe++,2);if(s.t=e,!s.__c&&(s.__=[n?n(t):Cn(void 0,t),function(c){var d=s.__N?s.__N[0]:s.__[0],l=s.t(d,c);d!==l&&(s.__N=[l,s.__[1]],s.__c.setState({}))}],s.__c=N,!N.__f)){var o=function(c,d,l){if(!s.__c.__H)return!0;var p=s.__c.__H.__.filter(function(f){return!!f.__c});if(p.every(function(f){return!f.__N}))return!i||i.call(this,c,d,l);var u=s.__c.props!==c;return p.forEach(function(f){if(f.__N){var h=f.__[0];f.__=f.__N,f.__N=void 0,h!==f.__[0]&&(u=!0)}}),i&&i.call(this,c,d,l)||u};N.__f=!0;var i=N.shouldComponentUpdate,r=N.componentWillUpdate;N.componentWillUpdate=function(c,d,l){if(this.__e){var p=i;i=void 0,o(c,d,l),i=p}r&&r.call(this,c,d,l)},N.shouldComponentUpdate=o}return s.__N||s.__}function k(e,t){var n=Ot(Oe++,3);!I.__s&&Sn(n.__H,t)&&(n.__=e,n.u=t,N.__H.__h.push(n))}function ce(e){return tt=5,nt(function(){return{current:e}},[])}function nt(e,t){var n=Ot(Oe++,7);return Sn(n.__H,t)&&(n.__=e(),n.__H=t,n.__h=e),n.__}function Os(){for(var e;e=kn.shift();)if(e.__P&&e.__H)try{e.__H.__h.forEach(et),e.__H.__h.forEach(Et),e.__H.__h=[]}catch(t){e.__H.__h=[],I.__e(t,e.__v)}}I.__b=function(e){N=null,_n&&_n(e)},I.__=function(e,t){e&&t.__k&&t.__k.__m&&(e.__m=t.__k.__m),wn&&wn(e,t)},I.__r=function(e){$n&&$n(e),Oe=0;var t=(N=e.__c).__H;t&&(Tt===N?(t.__h=[],N.__h=[],t.__.forEach(function(n){n.__N&&(n.__=n.__N),n.u=n.__N=void 0})):(t.__h.forEach(et),t.__h.forEach(Et),t.__h=[],Oe=0)),Tt=N},I.diffed=function(e){gn&&gn(e);var t=e.__c;t&&t.__H&&(t.__H.__h.length&&(kn.push(t)!==1&&vn===I.requestAnimationFrame||((vn=I.requestAnimationFrame)||Ns)(Os)),t.__H.__.forEach(function(n){n.u&&(n.__H=n.u),n.u=void 0})),Tt=N=null},I.__c=function(e,t){t.some(function(n){try{n.__h.forEach(et),n.__h=n.__h.filter(function(s){return!s.__||Et(s)})}catch(s){t.some(function(o){o.__h&&(o.__h=[])}),t=[],I.__e(s,n.__v)}}),bn&&bn(e,t)},I.unmount=function(e){yn&&yn(e);var t,n=e.__c;n&&n.__H&&(n.__H.__.forEach(function(s){try{et(s)}catch(o){t=o}}),n.__H=void 0,t&&I.__e(t,n.__v))};var xn=typeof requestAnimationFrame=="function";function Ns(e){var t,n=function(){clearTimeout(s),xn&&cancelAnimationFrame(t),setTimeout(e)},s=setTimeout(n,35);xn&&(t=requestAnimationFrame(n))}function et(e){var t=N,n=e.__c;typeof n=="function"&&(e.__c=void 0,n()),N=t}function Et(e){var t=N;e.__c=e.__(),N=t}function Sn(e,t){return!e||e.length!==t.length||t.some(function(n,s){return n!==e[s]})}function Cn(e,t){return typeof t=="function"?t(e):t}var Rs=Symbol.for("preact-signals");function rt(){if(te>1)te--;else{var e,t=!1;for(function(){var o=ot;for(ot=void 0;o!==void 0;){var i=o.S;if(i.v===o.v)for(var r=i.t;r!==void 0;r=r.x)r.i===o.i&&(r.i=i.i);o=o.o}}();Re!==void 0;){var n=Re;for(Re=void 0,st++;n!==void 0;){var s=n.u;if(n.u=void 0,n.f&=-3,!(8&n.f)&&Tn(n))try{n.c()}catch(o){t||(e=o,t=!0)}n=s}}if(st=0,te--,t)throw e}}function ue(e){if(te>0)return e();Nt=++As,te++;try{return e()}finally{rt()}}var Ne,E=void 0;function Ae(e){var t=E,n=Ne;E=void 0,Ne=void 0;try{return e()}finally{E=t,Ne=n}}var Re=void 0,te=0,st=0,As=0,Nt=0,ot=void 0,it=0;function Mn(e){if(E!==void 0){var t=e.n;if(t===void 0||t.t!==E)return t={i:0,S:e,p:E.s,n:void 0,t:E,e:void 0,x:void 0,r:t},E.s!==void 0&&(E.s.n=t),E.s=t,e.n=t,32&E.f&&e.S(t),t;if(t.i===-1)return t.i=0,t.n!==void 0&&(t.n.p=t.p,t.p!==void 0&&(t.p.n=t.n),t.p=E.s,t.n=void 0,E.s.n=t,E.s=t),t}}function P(e,t){this.v=e,this.i=0,this.n=void 0,this.t=void 0,this.l=0,this.W=t?.watched,this.Z=t?.unwatched,this.name=t?.name}P.prototype.brand=Rs;P.prototype.h=function(){return!0};P.prototype.S=function(e){var t=this,n=this.t;n!==e&&e.e===void 0&&(e.x=n,this.t=e,n!==void 0?n.e=e:Ae(function(){var s;(s=t.W)==null||s.call(t)}))};P.prototype.U=function(e){var t=this;if(this.t!==void 0){var n=e.e,s=e.x;n!==void 0&&(n.x=s,e.e=void 0),s!==void 0&&(s.e=n,e.x=void 0),e===this.t&&(this.t=s,s===void 0&&Ae(function(){var o;(o=t.Z)==null||o.call(t)}))}};P.prototype.subscribe=function(e){var t=this;return ye(function(){var n=t.value;Ae(function(){return e(n)})},{name:"sub"})};P.prototype.valueOf=function(){return this.value};P.prototype.toString=function(){return this.value+""};P.prototype.toJSON=function(){return this.value};P.prototype.peek=function(){var e=this;return Ae(function(){return e.value})};Object.defineProperty(P.prototype,"value",{get:function(){var e=Mn(this);return e!==void 0&&(e.i=this.i),this.v},set:function(e){if(e!==this.v){if(st>100)throw new Error("Cycle detected");(function(n){te!==0&&st===0&&n.l!==Nt&&(n.l=Nt,ot={S:n,v:n.v,i:n.i,o:ot})})(this),this.v=e,this.i++,it++,te++;try{for(var t=this.t;t!==void 0;t=t.x)t.t.N()}finally{rt()}}}});function S(e,t){return new P(e,t)}function Tn(e){for(var t=e.s;t!==void 0;t=t.n)if(t.S.i!==t.i||!t.S.h()||t.S.i!==t.i)return!0;return!1}function En(e){for(var t=e.s;t!==void 0;t=t.n){var n=t.S.n;if(n!==void 0&&(t.r=n),t.S.n=t,t.i=-1,t.n===void 0){e.s=t;break}}}function On(e){for(var t=e.s,n=void 0;t!==void 0;){var s=t.p;t.i===-1?(t.S.U(t),s!==void 0&&(s.n=t.n),t.n!==void 0&&(t.n.p=s)):n=t,t.S.n=t.r,t.r!==void 0&&(t.r=void 0),t=s}e.s=n}function de(e,t){P.call(this,void 0,t),this.x=e,this.s=void 0,this.g=it-1,this.f=4}de.prototype=new P;de.prototype.h=function(){if(this.f&=-3,1&this.f)return!1;if((36&this.f)==32||(this.f&=-5,this.g===it))return!0;if(this.g=it,this.f|=1,this.i>0&&!Tn(this))return this.f&=-2,!0;var e=E;try{En(this),E=this;var t=this.x();(16&this.f||this.v!==t||this.i===0)&&(this.v=t,this.f&=-17,this.i++)}catch(n){this.v=n,this.f|=16,this.i++}return E=e,On(this),this.f&=-2,!0};de.prototype.S=function(e){if(this.t===void 0){this.f|=36;for(var t=this.s;t!==void 0;t=t.n)t.S.S(t)}P.prototype.S.call(this,e)};de.prototype.U=function(e){if(this.t!==void 0&&(P.prototype.U.call(this,e),this.t===void 0)){this.f&=-33;for(var t=this.s;t!==void 0;t=t.n)t.S.U(t)}};de.prototype.N=function(){if(!(2&this.f)){this.f|=6;for(var e=this.t;e!==void 0;e=e.x)e.t.N()}};Object.defineProperty(de.prototype,"value",{get:function(){if(1&this.f)throw new Error("Cycle detected");var e=Mn(this);if(this.h(),e!==void 0&&(e.i=this.i),16&this.f)throw this.v;return this.v}});function B(e,t){return new de(e,t)}function Nn(e){var t=e.j;if(e.j=void 0,typeof t=="function"){te++;var n=E;E=void 0;try{t()}catch(s){throw e.f&=-2,e.f|=8,Rt(e),s}finally{E=n,rt()}}}function Rt(e){for(var t=e.s;t!==void 0;t=t.n)t.S.U(t);e.x=void 0,e.s=void 0,Nn(e)}function Is(e){if(E!==this)throw new Error("Out-of-order effect");On(this),E=e,this.f&=-2;try{8&this.f&&Rt(this)}finally{rt()}}function be(e,t){this.x=e,this.j=void 0,this.s=void 0,this.u=void 0,this.f=32,this.name=t?.name,Ne&&Ne.push(this)}be.prototype.c=function(){var e=this.S();try{if(8&this.f||this.x===void 0)return;var t=this.x();typeof t=="function"&&(this.j=t)}finally{e()}};be.prototype.S=function(){if(1&this.f)throw new Error("Cycle detected");this.f|=1,this.f&=-9,Nn(this),En(this),te++;var e=E;return E=this,Is.bind(this,e)};be.prototype.N=function(){2&this.f||(this.f|=2,this.u=Re,Re=this)};be.prototype.d=function(){this.f|=8,1&this.f||Rt(this)};be.prototype.dispose=function(){this.d()};function ye(e,t){var n=new be(e,t);try{n.c()}catch(o){throw n.d(),o}var s=n.d.bind(n);return s[Symbol.dispose]=s,s}var It,At;function we(e,t){x[e]=t.bind(null,x[e]||function(){})}function at(e){At&&At(),At=e&&e.S()}function Rn(e){var t=this,n=e.data,s=js(n);s.value=n;var o=nt(function(){for(var i=t,r=t.__v;r=r.__;)if(r.__c){r.__c.__$f|=4;break}var c=B(function(){var l=s.value.value;return l===0?0:l===!0?"":l||""}),d=B(function(){var l;return Ze(c.value)||((l=t.base)==null?void 0:l.nodeType)!==3});return t.__$u.c=function(){var l;!Ze(o.peek())&&((l=t.base)==null?void 0:l.nodeType)===3?t.base.data=o.peek():(t.__$f|=1,t.setState({}))},ye(function(){Ie||(Ie=this.N),this.N=In,d.value&&i.base&&(i.base.data=c.value)}),c},[]);return o.value}Rn.displayName="_st";Object.defineProperties(P.prototype,{constructor:{configurable:!0,value:void 0},type:{configurable:!0,value:Rn},props:{configurable:!0,get:function(){return{data:this}}},__b:{configurable:!0,value:1}});we("__b",function(e,t){if(typeof t.type=="string"){var n,s=t.props;for(var o in s)if(o!=="children"){var i=s[o];i instanceof P&&(n||(t.__np=n={}),n[o]=i,s[o]=i.peek())}}e(t)});we("__r",function(e,t){at();var n,s=t.__c;s&&(s.__$f&=-2,(n=s.__$u)===void 0&&(s.__$u=n=function(o){var i;return ye(function(){i=this}),i.c=function(){s.__$f|=1,s.setState({})},i}())),It=s,at(n),e(t)});we("__e",function(e,t,n,s){at(),It=void 0,e(t,n,s)});we("diffed",function(e,t){at(),It=void 0;var n;if(typeof t.type=="string"&&(n=t.__e)){var s=t.__np,o=t.props;if(s){var i=n.U;if(i)for(var r in i){var c=i[r];c!==void 0&&!(r in s)&&(c.d(),i[r]=void 0)}else n.U=i={};for(var d in s){var l=i[d],p=s[d];l===void 0?(l=Ps(n,d,p,o),i[d]=l):l.o(p,o)}}}e(t)});function Ps(e,t,n,s){var o=t in e&&e.ownerSVGElement===void 0,i=S(n);return{o:function(r,c){i.value=r,s=c},d:ye(function(){Ie||(Ie=this.N),this.N=In;var r=i.value.value;s[t]!==r&&(s[t]=r,o?e[t]=r:r?e.setAttribute(t,r):e.removeAttribute(t))})}}we("unmount",function(e,t){if(typeof t.type=="string"){var n=t.__e;if(n){var s=n.U;if(s){n.U=void 0;for(var o in s){var i=s[o];i&&i.d()}}}}else{var r=t.__c;if(r){var c=r.__$u;c&&(r.__$u=void 0,c.d())}}e(t)});we("__h",function(e,t,n,s){(s<3||s===9)&&(t.__$f|=2),e(t,n,s)});le.prototype.shouldComponentUpdate=function(e,t){var n=this.__$u;if(!(n&&n.s!==void 0||4&this.__$f)||3&this.__$f)return!0;for(var s in t)return!0;for(var o in e)if(o!=="__source"&&e[o]!==this.props[o])return!0;for(var i in this.props)if(!(i in e))return!0;return!1};function js(e){return nt(function(){return S(e)},[])}var Ie;var An=[];var Ds=function(e){queueMicrotask(function(){queueMicrotask(e)})};function Fs(){ue(function(){for(var e;e=An.shift();)Ie.call(e)})}function In(){An.push(this)===1&&(x.requestAnimationFrame||Ds)(Fs)}var Pe=S(innerWidth);addEventListener("resize",()=>Pe.value=innerWidth);var C=({title:e,note:t,id:n,children:s,className:o=""})=>a`
  <section class="card ${o}" aria-labelledby=${n}>
    <header class="card-head"><h2 id=${n}>${e}</h2>${t&&a`<p class="note">${t}</p>`}</header>
    ${s}
  </section>`,R=({problem:e})=>e&&a`
    <div class="problem" role="alert">
      <p><strong>${e.message}</strong>${e.code&&a` <span class="code">${e.code}</span>`}</p>
      ${e.hint&&a`<p>${e.hint}</p>`}
      ${e.diagnostics?.length>0&&a`<ul class="findings">
        ${e.diagnostics.slice(0,50).map(t=>a`<li>
          <span class="code">${t.code}</span> <span class="place">${Us(t.span)}</span> ${t.message}
          ${t.hint&&a`<span class="hint"> ${t.hint}</span>`}
          ${t.excerpt&&a`<pre tabindex="0">${t.excerpt}</pre>`}
        </li>`)}
      </ul>`}
    </div>`,Us=e=>[e.file,e.line,e.column].filter(Boolean).join(":");function z(){let e=ce(null),[t,n]=$(0);return k(()=>{let s=new ResizeObserver(([o])=>n(Math.floor(o.contentRect.width)));return s.observe(e.current),()=>s.disconnect()},[]),[e,t]}var Pt="aos-token",lt=class extends Error{constructor(t){super(t.detail||t.title||"the gateway cannot be reached"),Object.assign(this,{code:"",hint:"",diagnostics:[]},t)}},q=()=>!!localStorage.getItem(Pt);async function Pn(e){localStorage.setItem(Pt,e),await fetch("/v1/session",{method:"POST",headers:jn()})}var jn=()=>{let e=localStorage.getItem(Pt);return e?{authorization:`Bearer ${e}`}:{}};async function je(e,t={}){let n;try{n=await fetch(e,{...t,headers:{...jn(),...t.headers}})}catch{throw new lt({detail:"The gateway cannot be reached.",hint:"Is `aos serve` still running?"})}if(n.ok)return n;let s;try{s=await n.json()}catch{s={detail:`The gateway answered ${n.status}.`}}throw new lt(s)}var A=async e=>(await je(e)).json(),Dn=async e=>(await je(e)).blob(),Fn=async e=>(await je(e)).text(),ie=async(e,t={})=>(await je(e,{method:"POST",body:JSON.stringify(t),headers:{"content-type":"application/json"}})).json(),ct=async(e,t)=>(await je(`${e}?name=${encodeURIComponent(t.name)}`,{method:"POST",body:t})).json();var Dt=["overview","why","steps","model","documents","system"],jt=()=>{let[e,t=""]=location.hash.replace(/^#/,"").split("?"),[n="",s="",o="overview"]=e.split("/").filter(Boolean).map(decodeURIComponent),i=new URLSearchParams(t),r=Number(i.get("step"))||null;return{kind:n,name:s,view:Dt.includes(o)?o:"overview",step:r,token:i.get("token")}},w=S({kind:"",name:"",view:"overview",step:null}),j=(e,t="overview",n=null)=>`#/missions/${encodeURIComponent(e)}${t==="overview"?"":`/${t}`}${n?`?step=${n}`:""}`;function re(e,{replace:t=!1}={}){t?history.replaceState(null,"",e):history.pushState(null,"",e),w.value=jt()}async function Un(){let e=async()=>{let t=jt();if(t.token){let n=location.hash.replace(/([?&])token=[^&]*&?/,"$1").replace(/[?&]$/,"");history.replaceState(null,"",n||"#/"),await Pn(t.token).catch(()=>{})}w.value=jt()};addEventListener("hashchange",e),addEventListener("popstate",e),await e()}var xe=S(null),X=S(null),D=S(null),O=S(null),T=S([]),V=S([]),pe=new Map,Ut=S(0),fe=S(new Map),Fe=S(null),De=S([]),Z=S("connecting"),J=S([]),ke=S(!1),he=S(null),Wn=S(null),Ue=B(()=>T.value.at(-1)??null),me=B(()=>w.value.step===null),g=B(()=>{let e=T.value;if(!e.length)return null;let t=w.value.step;return t===null?e.at(-1):e[Math.min(Math.max(t-e[0].step,0),e.length-1)]}),ne=B(()=>g.value?g.value.step-T.value[0].step:-1),ve=B(()=>(Ut.value,g.value?pe.get(g.value.step)??null:null)),dt=B(()=>{let e=new Map;for(let t of T.value.slice(0,ne.value+1)){t.adopted&&e.clear();for(let n of t.drift??[]){let s=`${n.skill} ${n.response}`;e.set(s,{...n,since:e.get(s)?.since??t.step})}}return[...e.values()]}),K=null,ut=[],Ft=!1;function F(e){let{name:t,view:n}=w.value,s=Ue.value?.step;re(j(t,n,e===null||e>=s?null:Math.max(e,T.value[0]?.step??1)),{replace:!0})}async function Le(){try{xe.value=(await A("/v1/runs?limit=100")).runs,X.value=null}catch(e){X.value=e}}function pt(e="",t=0){K?.close();let n=e?`?mission=${encodeURIComponent(e)}&since=${t}`:"";K=new EventSource(`/v1/events${n}`);let s=K;K.onopen=()=>Z.value=O.value?.phase==="ended"?"over":"live",K.onerror=()=>{s===K&&(Z.value="lost",s.readyState===EventSource.CLOSED&&setTimeout(()=>s===K&&Ls(e),1500))};for(let o of["decision","state","service","progress","bundle","runs"])K.addEventListener(o,i=>{ut.push([o,JSON.parse(i.data)]),Ft||(Ft=!0,document.hidden?setTimeout(Ln,200):requestAnimationFrame(Ln))})}var Ls=e=>e?ft(e,{again:!0}):pt();async function ft(e,{again:t=!1}={}){let n=performance.now(),s=`/v1/missions/${encodeURIComponent(e)}`;t||Hn(),Z.value=t?"lost":"connecting";try{let[o,i]=await Promise.all([A(s),A(`${s}/trace`)]);if(w.value.name!==e)return;ue(()=>{pe.clear(),D.value=o,O.value=o.state??null,ke.value=i.draws,T.value=i.steps.map(Vn),V.value=Gn(T.value),X.value=null,Wn.value=performance.now()-n}),pt(e,i.next),qn(e)}catch(o){X.value=o,t&&setTimeout(()=>w.value.name===e&&ft(e,{again:t}),1500)}}function Hn(){K?.close(),K=null,ut=[],pe.clear(),ue(()=>{D.value=O.value=Fe.value=he.value=Wn.value=null,T.value=V.value=De.value=J.value=[],fe.value=new Map,ke.value=!1})}var zn=()=>Hn();async function qn(e){try{J.value=(await A(`/v1/missions/${encodeURIComponent(e)}/world`)).steps}catch{J.value=[]}}async function Bn(e){if(pe.has(e)||!D.value)return;let{name:t}=w.value;try{let n=await A(`/v1/missions/${encodeURIComponent(t)}/decisions/${e}`);if(w.value.name!==t)return;pe.set(e,n),Ut.value++}catch{}}var Vn=e=>({status:"",surprise:0,...e});function Ln(){Ft=!1;let e=ut;ut=[],ue(()=>{let t=[];for(let[n,s]of e)n==="decision"?t.push(s):n==="state"?Ws(s):n==="service"?fe.value=new Map(fe.value).set(s.service,s.is_there):n==="progress"?Fe.value=s:n==="bundle"?De.value=[s,...De.value].slice(0,20):n==="runs"&&(xe.value=s);t.length&&Hs(t)})}function Ws(e){if(w.value.name&&e.mission!==w.value.name){e.phase!=="waiting"&&(he.value=e.mission);return}O.value=e,e.phase==="ended"?(Z.value="over",A(`/v1/missions/${encodeURIComponent(e.mission)}`).then(t=>w.value.name===e.mission&&(D.value=t),()=>{}),qn(e.mission)):Z.value==="over"&&(Z.value="live")}function Hs(e){let t=T.value.slice(),n=t.length;for(let{record:s,row:o}of e){let i=Vn(o),r=t.length?i.step-t[0].step:0;if(r<0)continue;let c=t[r];if(c&&c.sequence>=i.sequence)continue;t[r]=c&&s.outcome?{...c,...i,belief:{...c.belief,...i.belief},endings:c.endings,predicted:c.predicted}:i,n=Math.min(n,r);let d={...pe.get(i.step)};d[s.outcome?"observed":"decided"]=s,(d.decided||!s.outcome)&&pe.set(i.step,d),s.outcome&&(Fe.value=null,!J.value.includes(i.step)&&J.value.length&&(J.value=[...J.value,i.step]))}T.value=t,V.value=Gn(t,V.value,n),Ut.value++}function Gn(e,t=[],n=0){let s=t.slice(0,n+(n?1:0));for(let o=s.length?s.length-1:0;o<e.length;o++){let i={...s[o]??{},...e[o].belief??{}};s[o]=i,s[o+1]={...i,...e[o].after??{}}}return s}var W=e=>typeof e=="number"&&Number.isFinite(e);function U(e,t=2){if(!W(e))return"–";let n=Math.abs(e)>=1e3?Math.round(Math.abs(e)).toLocaleString("en"):Math.abs(e).toFixed(t);return`${e<0?"−":"+"}${n}`}var H=(e,t=2)=>W(e)?e.toFixed(t):"–";function M(e){return W(e)?e>.9995&&e<1?">0.999":e<5e-4&&e>0?"<0.001":e.toFixed(3):"–"}function Q(e){return W(e)?e>.995&&e<1?">99 %":e<.005&&e>0?"<1 %":`${Math.round(e*100)} %`:"–"}function We(e){return W(e)?e<.001?"<1 ms":e<1?`${Math.round(e*1e3)} ms`:e<60?`${e.toFixed(1)} s`:`${Math.floor(e/60)} min ${Math.round(e%60)} s`:""}function ht(e){let t=new Date(e);if(Number.isNaN(t.getTime()))return"";let n=t.toDateString()===new Date().toDateString(),s=t.toLocaleTimeString([],{hour:"2-digit",minute:"2-digit"});return n?`today, ${s}`:`${t.toLocaleDateString([],{day:"numeric",month:"short"})}, ${s}`}var zs={goal:"Goal reached",over:"Over, no goal",failure:"Failed",nothing_worthwhile:"Nothing worth doing",too_risky:"Too risky",step_limit:"Step limit",skills_failed:"Skills kept failing",cancelled:"Cancelled",fault:"Fault",not_started:"Not started",stopped:"Stopped",killed:"Killed",running:"Running",unreachable:"Unreachable"},mt=e=>zs[e]??e,qs={waiting:"Waiting",building:"Building the model",planning:"Deciding",acting:"Acting",holding:"Holding"},Kn=e=>qs[e]??e,Y=e=>e.replace(/([(,] ?)\w+=/g,"$1");function Zn(){let e=xe.value,t=(e??[]).filter(s=>s.is_running),n=(e??[]).filter(s=>!s.is_running);return a`<main class="home" id="main">
    <div class="home-list">
      <h1>Missions</h1>
      <${R} problem=${X.value} />
      ${e===null&&!X.value&&a`<p class="empty">Looking for runs…</p>`}
      ${t.length>0&&a`<h2 class="group">Running</h2><ul class="runs">${t.map(s=>a`<${Jn} key=${s.run} run=${s} />`)}</ul>`}
      ${n.length>0&&a`<h2 class="group">Past</h2><ul class="runs">${n.map(s=>a`<${Jn} key=${s.run} run=${s} />`)}</ul>`}
      ${e?.length===0&&a`<div class="welcome">
        <p>No mission has run in this folder yet.</p>
        <p>Start one here, or with <code>aos-up</code> in a terminal: it appears by itself.</p>
      </div>`}
    </div>
    <aside class="home-aside"><${Bs} /></aside>
  </main>`}function Jn({run:e}){let t=e.missions??[],n=t.at(-1)??e.run,s=e.deploy_file?.split("/").at(-1)?.replace(/\.ya?ml$/,"");return a`<li class=${e.is_running?"run is-running":"run"}>
    <a href=${j(n)}>
      <span class="run-name"><b>${e.robot}</b>${s&&s!==e.robot?a`<span class="muted">${s}</span>`:""}</span>
      <span class=${`ending is-${e.ending}`}>${e.is_running&&a`<i class="pulse"></i>`}${mt(e.ending)}</span>
      <span class="run-when muted">${ht(e.started)||e.endpoint}</span>
    </a>
    ${t.length>1&&a`<details><summary>${t.length} missions</summary><ul class="of-run">${t.slice().reverse().map((o,i)=>a`<li><a href=${j(o)}>Mission ${t.length-i}</a></li>`)}</ul></details>`}
  </li>`}function Bs(){let[e,t]=$([]),[n,s]=$(""),[o,i]=$({model:!0,stay:!1,seed:""}),[r,c]=$(null),[d,l]=$(""),p=()=>A("/v1/projects").then(v=>{t(v.projects),s(m=>m||v.projects[0]?.deploy_file||"")},c);k(()=>void p(),[]);async function u(v){v.preventDefault(),l("Starting…"),c(null);try{let m={deploy_file:n,model:o.model,stay:o.stay};o.seed!==""&&(m.seed=Number(o.seed));let _=await ie("/v1/runs",m);await Le(),re(j(_.mission))}catch(m){c(m)}l("")}async function f(v){let m=v.target.files[0];if(m){l(`Checking ${m.name}…`),c(null);try{let _=await ct("/v1/projects",m);await p(),s(_.deploy_file)}catch(_){c(_)}l(""),v.target.value=""}}let h=(v,m)=>i({...o,[v]:m});return q()?a`<section class="card start" aria-labelledby="start">
    <h2 id="start">New mission</h2>
    <form onSubmit=${u}>
      <label class="field">Project
        <select value=${n} onChange=${v=>s(v.target.value)}>
          ${e.map(v=>a`<option value=${v.deploy_file}>${v.project}${v.is_uploaded?" (uploaded)":""}</option>`)}
          ${!e.length&&a`<option value="">No deploy file in this folder</option>`}
        </select></label>
      <label class="field">Seed <input inputmode="numeric" pattern="[0-9]*" placeholder="that of the file" value=${o.seed} onInput=${v=>h("seed",v.target.value)} /></label>
      <label class="check"><input type="checkbox" checked=${o.model} onChange=${v=>h("model",v.target.checked)} /> Skills are played by their documents; no robot moves</label>
      <label class="check"><input type="checkbox" checked=${o.stay} onChange=${v=>h("stay",v.target.checked)} /> Stay for further missions</label>
      <button class="primary" disabled=${!n||!!d}>Start mission</button>
      <p role="status" class="note">${d}</p>
    </form>
    <hr />
    <label class="button">Upload a bundle…<input type="file" class="visually-hidden" onChange=${f} accept=".zip,.tar,.gz,.tgz,.xz,.bz2" /></label>
    <p class="note">An archive of documents. It is checked first, and played by its own documents.</p>
    <${R} problem=${r} />
  </section>`:a`<section class="card start" aria-labelledby="start"><h2 id="start">New mission</h2>
      <p class="note">Open the address that <code>aos serve</code> prints, to start missions here. Without it this page only reads.</p></section>`}var Lt=S(null),$e=S(""),Xn=()=>q()&&D.value?.is_running&&O.value&&O.value.phase!=="ended",Vs=()=>!!O.value?.held_by||O.value?.phase==="holding";async function _e(e,t={}){let{name:n}=w.value;$e.value=e,Lt.value=null;try{await ie(`/v1/missions/${encodeURIComponent(n)}/steering`,{verb:e,...t})}catch(s){Lt.value=s}$e.value=""}function Qn(){if(he.value)return a`<a class="button primary" href=${j(he.value)}>To the next mission</a>`;if(!D.value?.is_running||!O.value||O.value.phase==="ended")return null;if(!q())return a`<p class="controls note">Read only</p>`;let e=!!$e.value;return a`<div class="controls" role="group" aria-label="Steering">
    ${Vs()?a`<button class="primary" disabled=${e} onClick=${()=>_e("resume")}>Go on</button>`:a`<button disabled=${e} onClick=${()=>_e("hold")}>Hold</button>`}
    <button disabled=${e} onClick=${()=>_e("step")} title="One more decision, then hold">Step</button>
    <button class="stop" disabled=${$e.value==="stop"} onClick=${()=>_e("stop")}>${$e.value==="stop"?"Stopping…":"Stop"}</button>
    <${R} problem=${Lt.value} />
  </div>`}var Yn=({action:e})=>Xn()&&a`<span class="of-action">
    <button class="quiet" disabled=${!!$e.value} onClick=${()=>_e("act",{actions:[e]})} aria-label=${`Do ${e}`}>Do</button>
    <button class="quiet" disabled=${!!$e.value} onClick=${()=>_e("leave_out",{name:e})} aria-label=${`Leave out ${e}`}>Leave out</button>
  </span>`;function es(){let e=Object.entries(O.value?.left_out??{}),t=O.value?.asked??[];return!e.length&&!t.length?null:a`<div class="left-out">
    ${t.length>0&&a`<p class="aside">Still to come: ${t.map(n=>a`<span class="chip">${n}</span> `)}</p>`}
    ${e.map(([n,s])=>a`<p class="aside"><span class="chip">${n}</span> is left out by ${s} ${Xn()&&a`<button class="link" onClick=${()=>_e("take_back",{name:n})}>Take it back</button>`}</p>`)}
  </div>`}function ts(){let[e,t]=$(!1),[n,s]=$({belief:"initial",given:"",idle:"0"}),[o,i]=$({}),[r,c]=$(null),[d,l]=$(!1),p=D.value?.run,u=O.value?.phase==="ended";if(k(()=>{!p||!u||!q()||A(`/v1/runs/${encodeURIComponent(p)}`).then(m=>t(m.is_running&&m.stays&&m.missions.at(-1)===O.value?.mission),()=>t(!1))},[p,u]),!e||he.value||!q())return null;let f=Object.entries(D.value?.parameters??{}),h=m=>_=>s({...n,[m]:_.target.value});async function v(m){m.preventDefault(),l(!0),c(null);let _={belief:n.belief,idle:Number(n.idle||0),given:n.given.split(`
`).map(b=>b.trim()).filter(Boolean),values:o};try{re(j((await ie(`/v1/runs/${encodeURIComponent(p)}/missions`,_)).mission))}catch(b){c(b),l(!1)}}return a`<details class="card next">
    <summary>Next mission</summary>
    <form onSubmit=${v}>
      <label class="field">Belief at the start
        <select value=${n.belief} onChange=${h("belief")}><option value="initial">the initial one</option><option value="keep">the last one of this mission</option></select></label>
      <label class="field">Idle steps before it <input type="number" min="0" max="10000" value=${n.idle} onInput=${h("idle")} /></label>
      ${f.map(([m,_])=>a`<label class="field" key=${m}>${m}
        <input value=${o[m]??_} onInput=${b=>i({...o,[m]:b.target.value})} /></label>`)}
      <label class="field wide">What is known, one expression a line <textarea rows="2" placeholder="state.robot_at == Kitchen" value=${n.given} onInput=${h("given")}></textarea></label>
      <button class="primary" disabled=${d}>${d?"Beginning…":"Begin it"}</button>
    </form>
    <${R} problem=${r} />
  </details>`}var ns=["#4477aa","#ccbb44","#66ccee","#aa3377","#228833","#ee6677","#8a8f98"],Gs=new Set(["#ccbb44","#66ccee","#ee6677"]),Ks=new Set(["false","no","none","0"]),Wt=e=>ns[e%ns.length],vt=e=>e.startsWith("var")?"var(--ink)":Gs.has(e)?"#14171a":"#ffffff";function ss(e){let t=new Map,n=0;for(let s of e){let o=Ks.has(s.toLowerCase())||s==="…";t.set(s,o?"var(--quiet)":Wt(n++))}return t}var Ht=26,Js=2,L=(e,t,n=0)=>n+e/Math.max(1,T.value.length)*(t-n),He=e=>e.impossible||e.surprise>=Js,_t=e=>e.chosen_by==="operator"||e.chosen_by==="script",ze=e=>!!e.status&&e.status!=="observed",Zs=()=>{let e=new Map;for(let t of T.value)e.has(t.skill)||e.set(t.skill,Wt(e.size));return e};function zt({room:e,height:t,head:n=0}){if(ne.value<0)return null;let s=L(ne.value,e,n),o=L(ne.value+1,e,n);return a`<rect class="cursor" x=${s+.75} y="0.75" width=${Math.max(1.5,o-s-1.5)} height=${t-1.5} rx="2" />`}function os(){let[e,t]=z(),n=T.value,s=Zs(),o=g.value;if(!n.length)return a`<div class="timeline" ref=${e}></div>`;let i=n[0].step,r=Ue.value.step;return a`<div class="timeline">
    <div class="timeline-track" ref=${e}>
      <svg width=${t} height=${Ht+12} aria-hidden="true">
        <g transform="translate(0 12)">
          ${t>0&&Xs(n,t,s)}
          <${zt} room=${t} height=${Ht} />
        </g>
        ${t>0&&Qs(n,t)}
      </svg>
      <input type="range" min=${i} max=${r} step="1" value=${o.step}
        aria-label="Step" aria-valuetext=${`step ${o.step}, ${o.action}`}
        onInput=${c=>F(Number(c.target.value))} />
    </div>
    <div class="timeline-foot">
      <ul class="legend" aria-label="Skills">
        ${[...s].map(([c,d])=>a`<li><i style=${{background:d}}></i>${c}</li>`)}
        ${n.some(He)&&a`<li><svg width="10" height="9" aria-hidden="true"><path class="surprise" d="M5 0 l5 9 h-10z" /></svg>surprise</li>`}
        ${n.some(ze)&&a`<li><svg width="9" height="9" aria-hidden="true"><path class="failed" d="M1 1 l7 7 M8 1 l-7 7" /></svg>not observed</li>`}
        ${n.some(_t)&&a`<li><svg width="9" height="9" aria-hidden="true"><rect class="asked" x="1" y="1" width="7" height="7" rx="1" /></svg>asked for by a person</li>`}
        ${n.some(c=>c.adopted)&&a`<li><svg width="9" height="9" aria-hidden="true"><path class="adopted" d="M4.5 0 l4.5 4.5 l-4.5 4.5 l-4.5 -4.5z" /></svg>new model</li>`}
      </ul>
      <div class="stepper">
        <button class="quiet" onClick=${()=>F(o.step-1)} disabled=${o.step<=i} aria-label="Step before">‹</button>
        <span class="stepper-place"><b>${o.step}</b> of ${r}</span>
        <button class="quiet" onClick=${()=>F(o.step+1)} disabled=${o.step>=r} aria-label="Step after">›</button>
        <button class=${`quiet newest ${me.value?"is-on":""}`} aria-pressed=${me.value} onClick=${()=>F(null)}>
          ${O.value?.phase==="ended"?"Last":"Newest"}</button>
      </div>
    </div>
  </div>`}function Xs(e,t,n){let s=L(1,t)-L(0,t),o=s>6?2:0,i=[];for(let r=0;r<e.length;){let c=r+1;if(!o)for(;c<e.length&&e[c].skill===e[r].skill;)c++;let d=n.get(e[r].skill),l=Math.max(1,(c-r)*s-o),p=Y(e[r].action),u=!e[r].status;i.push(a`<rect class=${u?"open":""} x=${L(r,t)} y="0" width=${l} height=${Ht} rx="2" style=${{fill:d,stroke:u?d:"none"}} />`),l>p.length*7.2+12&&i.push(a`<text x=${L(r,t)+6} y="17" style=${{fill:u?"var(--ink)":vt(d)}}>${p}</text>`),r=c}return i}function Qs(e,t){return e.map((n,s)=>{let o=L(s+.5,t);return[He(n)&&a`<path class="surprise" d=${`M${o} 1 l4.5 8 h-9z`}><title>${`step ${n.step}: surprise ${n.impossible?"without end":H(n.surprise)}, expected with ${M(n.expected)}`}</title></path>`,ze(n)&&a`<path class="failed" d=${`M${o-3.5} 2 l7 7 M${o+3.5} 2 l-7 7`} />`,_t(n)&&a`<rect class="asked" x=${L(s+.5,t)-(He(n)||ze(n)?12:3.5)} y="2" width="7" height="7" rx="1" />`,n.adopted&&a`<path class="adopted" d=${`M${L(s,t)} 1 l4 4 l-4 4 l-4 -4z`} />`]})}function is(){let e=g.value;return e?a`<div class="decision">
    <p class="sentence"><span class="action">${e.action}</span> ${Ys(e)}</p>
    <p class="came">${eo(e)}</p>
    ${e.fault&&a`<p class="came fault">${e.fault}</p>`}
    ${e.remark&&a`<p class="came">${e.remark}</p>`}
    ${e.adopted&&a`<p class="came">A new model decided: ${e.adopted}.</p>`}
  </div>`:a`<p class="sentence muted">${O.value?.remark?`${O.value.remark}.`:"No decision has been made yet."}</p>`}function Ys(e){let t=[e.planner,e.simulations?`${e.simulations.toLocaleString("en")} simulations`:"",We(e.planning_s)].filter(Boolean).join(", "),n=t&&a`<span class="by">${t}</span>`;if(_t(e))return e.chosen_by==="script"?a`comes from a script of a person.`:a`was asked for by a person.`;if(!W(e.value))return a`was chosen. ${n}`;let s=a`is worth <b>${U(e.value)}</b>${e.error>=.005?` ± ${H(e.error)}`:""}`;if(!e.second)return a`${s}; nothing else can be done. ${n}`;let o=Math.hypot(e.error??0,e.second_error??0),i=a`<span class="other">${e.second}</span>`;return W(e.margin)&&Math.abs(e.margin)<2*o?a`${s}, too close to call against ${i}. ${n}`:e.margin<0?a`${s}, ${H(-e.margin)} less than ${i}. ${n}`:e.margin===0?a`${s}, as much as ${i}. ${n}`:a`${s}, <b>${H(e.margin)}</b> more than ${i}. ${n}`}function eo(e){let n=Object.entries(e.predicted??{}).sort((i,r)=>r[1]-i[1]).slice(0,3).map(([i,r],c)=>a`${c?", ":""}<span class="response">${i}</span> ${Q(r)}`);if(!e.status){let i=Fe.value;return a`Expected ${n}. ${i&&i.id?.step===e.step?`${i.state}${i.progress?`, ${Q(i.progress)}`:""}${i.text?`: ${i.text}`:""}`:a`<span class="waiting">It is running.</span>`}`}if(e.status!=="observed")return a`Expected ${n}. Nothing was observed: <b>${e.status.replace("_"," ")}</b>.`;let s=e.impossible?"The model held that impossible.":`Surprise ${H(e.surprise)}.`,o=e.stopped_by?` It was stopped by ${e.stopped_by}.`:"";return a`Expected ${n}. Saw <b class="response">${e.seen}</b>${W(e.expected)?` (${M(e.expected)})`:""}.${o} ${s}`}var se=40,qt=8,to=12,no=.2;function as(){let[e,t]=z(),[n,s]=$(!1),o=V.value,i=Vt(o),r=i.filter(p=>p.isDoubtful||p.isMoving),c=n?r:r.slice(0,qt),d=i.filter(p=>!p.isDoubtful&&!p.isMoving),l=ne.value;return a`<div class="ribbons" ref=${e}>
    ${t>0&&c.map(p=>a`<${so} key=${p.name} row=${p} all=${o} size=${t} now=${l} />`)}
    ${r.length>qt&&a`<button class="link" onClick=${()=>s(!n)}>
      ${n?"Show fewer":`Show ${r.length-qt} more`}</button>`}
    ${d.length>0&&a`<p class="still"><span>Certain throughout</span>
      ${d.slice(0,40).map(p=>a`<span class="chip"><b>${p.name}</b> ${p.values[0]}</span>`)}</p>`}
    ${!i.length&&a`<p class="empty">There is no belief yet.</p>`}
  </div>`}function so({row:e,all:t,size:n,now:s}){let o=Pe.value<720,i=Math.max(60,o?n:n-330),r=$t(i),c=ss(e.values),d=t[s+1]?.[e.name]??{},l=Object.entries(d).sort((u,f)=>f[1]-u[1]),p=l.slice(0,2).map(([u,f])=>`${u} ${M(f)}`).join(", ");return a`<div class="ribbon">
    <h3 class="ribbon-name">${e.name}</h3>
    <svg class=${i>4*t.length?"ribbon-plot":"ribbon-plot is-dense"} width=${i} height=${se} role="img" aria-label=${`${e.name}: ${p}`}
      onClick=${u=>F(oo(u,i))}>
      ${io(e,t,i,c)}
      ${e.moves.length<=to&&e.moves.map(u=>a`<path class="moved" d=${`M${L(u-1,i,r)} ${se} l-3.5 5 h7 z`} />`)}
      ${ro(e,t,i,c)}
      <${zt} room=${i} height=${se} head=${r} />
    </svg>
    <dl class="ribbon-now">
      ${l.slice(0,2).map(([u,f])=>a`<div><dt><i style=${{background:c.get(u)}}></i>${u}</dt><dd>${M(f)}</dd></div>`)}
    </dl>
  </div>`}var $t=e=>Math.min(24,e/(T.value.length+.5)*.5),oo=(e,t)=>{let n=T.value.length,s=e.clientX-e.currentTarget.getBoundingClientRect().left,o=$t(t),i=Math.min(n-1,Math.max(0,Math.floor((s-o)/(t-o)*n)));return T.value[i]?.step};function io(e,t,n,s){let o=t.length-1;if(o<1)return null;let i=$t(n),r=Math.min(8,n/o*.4),c=new Float64Array(t.length);return e.values.map(d=>{let l="",p="",u=!1;for(let f=0;f<=o;f++){let h=t[f][e.name]?.[d]??0;h>0&&(u=!0);let v=se-c[f]*se;c[f]+=h;let m=se-c[f]*se,_=f===0?0:L(f-1,n,i)+r/2,b=f===o?n:Math.max(_,L(f,n,i)-r/2);l+=`${l?"L":"M"}${_.toFixed(1)} ${m.toFixed(1)}L${b.toFixed(1)} ${m.toFixed(1)}`,p=`L${b.toFixed(1)} ${v.toFixed(1)}L${_.toFixed(1)} ${v.toFixed(1)}${p}`}return u?a`<path d=${`${l}${p}Z`} style=${{fill:s.get(d)}} />`:null})}function ro(e,t,n,s){let o=[],i=t.length-1,r=$t(n),c=0,d=null,l=p=>{let u=c===0?0:L(c-1,n,r),f=p>i?n:L(p-1,n,r);if(!d||f-u<d.length*7+14)return;let h=0,v=t[c][e.name]??{};for(let _ of e.values){if(_===d)break;h+=v[_]??0}let m=se-(h+(v[d]??0)/2)*se;o.push(a`<text x=${u+8} y=${m+4} style=${{fill:vt(s.get(d))}}>${d}</text>`)};for(let p=0;p<=i;p++){let[u,f]=Object.entries(t[p][e.name]??{}).reduce((v,m)=>m[1]>v[1]?m:v,["",0]),h=f>=.5?u:null;h!==d&&(l(p),c=p,d=h)}return l(i+1),o}var Bt={all:null,rows:[]};function Vt(e){if(Bt.all===e)return Bt.rows;let t=new Map;for(let s=0;s<e.length;s++)for(let o in e[s]){let i=e[s][o],r=s?e[s-1][o]:void 0,c=t.get(o);c||t.set(o,c={name:o,weights:new Map,doubt:0,isDoubtful:!1,isMoving:!1,moves:[]});let d=0;for(let l in i){let p=i[l];c.weights.set(l,(c.weights.get(l)??0)+p),p>0&&p<1&&(d-=p*Math.log(p))}if(d>.005&&(c.isDoubtful=!0),c.doubt+=d,r&&r!==i){let l=lo(r,i);l>1e-4&&(c.isMoving=!0),l>=no&&c.moves.push(s)}}let n=[...t.values()].map(s=>({...s,values:[...s.weights.entries()].sort(ao).map(([o])=>o)}));return n.sort((s,o)=>o.doubt-s.doubt||o.moves.length-s.moves.length),Bt={all:e,rows:n},n}var rs=e=>e==="true"?-1:e==="false"||e==="…"?1:0,ao=(e,t)=>rs(e[0])-rs(t[0]);function lo(e,t){let n=0;for(let s in e)n+=Math.abs(e[s]-(t[s]??0));for(let s in t)s in e||(n+=t[s]);return n/2}var ls=8,co=30;function cs(){let[e,t]=z(),[n,s]=$(!1),o=ve.value?.decided??ve.value?.observed;if(!g.value||!o||o.step!==g.value.step)return a`<div ref=${e} class="values" aria-busy="true"></div>`;let i=o.actions.filter(l=>W(l.q)).sort((l,p)=>p.q-l.q),r=n?i:i.slice(0,ls),c=i.find(l=>l.action===o.action);c&&!r.includes(c)&&(r=[...r,c]);let d=po(r);return a`<div class="values" ref=${e}>
    <ol>
      ${r.map(l=>a`<${uo} key=${l.action} each=${l} scale=${d} size=${t} found=${o} />`)}
    </ol>
    ${i.length>ls&&a`<button class="link" onClick=${()=>s(!n)}>${n?"Show fewer":`Show all ${i.length}`}</button>`}
    ${!i.length&&a`<p class="empty">${o.planner?`${o.planner} gives no values.`:"There are no values."}</p>`}
    ${Object.entries(o.set_aside??{}).map(([l,p])=>a`<p class="aside"><b>${l}</b> is set aside: ${p}</p>`)}
    ${(o.constraints??[]).map(l=>a`<p class="aside">Never <code>${l.never}</code>: risks ${l.risk.toPrecision(2)} of ${l.left.toPrecision(2)} that are left.</p>`)}
  </div>`}function uo({each:e,scale:t,size:n,found:s}){let o=e.action===s.action,i=Math.max(80,n-(Pe.value<480?84:92)),r=l=>t(l)*(i-16)+8,c=e.stderr??0,d=`${e.action}: ${U(e.q)}${c>=.005?` ± ${c.toFixed(2)}`:""}${o?", chosen":""}`;return a`<li class=${o?"value is-chosen":"value"} aria-label=${d}>
    <span class="value-head"><span class="value-name" title=${e.action}>${o&&a`<span class="chosen-mark" aria-hidden="true">▸</span>`}${Y(e.action)}</span><${Yn} action=${e.action} /></span>
    <span class="value-plot">
      <svg width=${i} height=${co-12} aria-hidden="true">
        <line class="rail" x1="8" x2=${i-8} y1="9" y2="9" />
        ${W(e.at_least)&&W(e.at_most)&&a`<line class="proven" x1=${r(e.at_least)} x2=${r(e.at_most)} y1="9" y2="9" />`}
        ${c>0&&a`<line class="error" x1=${r(e.q-2*c)} x2=${r(e.q+2*c)} y1="9" y2="9" />`}
        <circle cx=${r(e.q)} cy="9" r=${o?5.5:4} />
      </svg>
      <span class="value-number">${U(e.q)}</span>
    </span>
  </li>`}function po(e){let t=e.flatMap(o=>[o.q-2*(o.stderr??0),o.q+2*(o.stderr??0)]).filter(W),n=Math.min(...t),s=Math.max(...t)-n||1;return o=>Math.min(1,Math.max(0,(o-n)/s))}var fo=4,ho=3;function ds({name:e,step:t,seen:n}){let[s,o]=$(0),[i,r]=$(null),[c,d]=$(null),[l,p]=$(!1);k(()=>{if(!s)return;let f=!0;return p(!0),d(null),A(`/v1/missions/${encodeURIComponent(e)}/decisions/${t}/tree?depth=${s}&branches=${ho}`).then(h=>f&&r(h),h=>f&&d(h)).then(()=>f&&p(!1)),()=>{f=!1}},[s]);let u=f=>a`<button class="quiet" disabled=${l} onClick=${()=>o(f)}>${l?"Growing…":f>2?"One decision deeper":"Show the tree"}</button>`;return a`<${C} id="tree" title="Looking ahead" className="tree" note="The best actions with value, error and simulations; after each the likeliest responses. Every belief is planned anew.">
    <${R} problem=${c} />
    <div role="status" aria-busy=${l}>${i&&a`<${ps} node=${i.root} seen=${n} />
      ${!i.is_whole&&a`<p class="aside">The rest was left out for its size.</p>`}`}</div>
    ${s?s<fo&&u(s+(c?0:1)):u(2)}
  <//>`}function ps({node:e,seen:t}){return e.actions?.length?a`<ul class="branches">${e.actions.map((n,s)=>a`<li>
    ${n.after?.length?a`<details open=${t!==void 0&&s===0}><summary><${us} each=${n} /></summary>
          <ul class="branches">${n.after.map(([o,i,r])=>a`<li><details open=${o===t}>
            <summary><span class="response">${o}</span> <span class="muted">${Q(i)}, goal ${M(r.goal_probability)}${o===t?", seen":""}</span></summary>
            <${ps} node=${r} />
          </details></li>`)}</ul>
        </details>`:a`<${us} each=${n} />`}
  </li>`)}</ul>`:a`<p class="muted">over; goal ${M(e.goal_probability)}</p>`}var us=({each:e})=>a`<span class="action">${e.action}</span> <b>${U(e.q)}</b>${e.stderr>=.005&&a` <span class="muted">± ${e.stderr.toFixed(2)}</span>`}${e.n>0&&a` <span class="muted">${e.n.toLocaleString("en")} simulations</span>`}`;var Gt=new Map,fs=e=>e.margin<0?e.action:e.other,mo=e=>({operator:", which an operator has asked for",script:", which a script has asked for"})[e.chosen_by]??"";function hs(){let[e,t]=$(""),[n,s]=$(null),[o,i]=$(null),r=g.value?.step,{name:c}=w.value;if(k(()=>t(""),[c,r]),k(()=>{if(!r)return;let l=`/v1/missions/${encodeURIComponent(c)}/decisions/${r}/why?instead=${encodeURIComponent(e)}`;if(i(null),s(Gt.get(l)??null),Gt.has(l))return;let p=!0,u=setTimeout(()=>A(l).then(f=>{g.value?.status&&Gt.set(l,f),p&&s(f)},f=>p&&i(f)),150);return()=>{p=!1,clearTimeout(u)}},[c,r,e]),!r)return a`<p class="empty">There is no decision yet.</p>`;let d=(ve.value?.decided?.actions??[]).map(l=>l.action).filter(l=>l!==g.value.action);return a`<div class="why" aria-busy=${!n&&!o}>
    <p class="why-head">Why <span class="action">${g.value.action}</span>${n&&mo(n)}
      <label> and not <select value=${e} onChange=${l=>t(l.target.value)}>
        <option value="">the runner-up${n&&!e?`, ${n.other}`:""}</option>
        ${d.map(l=>a`<option value=${l}>${l}</option>`)}
      </select></label></p>
    <${R} problem=${o} />
    ${!n&&!o&&a`<p class="empty">An engine of its own is brought to this step…</p>`}
    ${n&&a`<${vo} why=${n} />`}
    ${r&&a`<${ds} key=${`tree ${c} ${r}`} name=${c} step=${r} seen=${g.value.seen} />`}
    ${r&&a`<${yo} key=${`${c} ${r}`} name=${c} step=${r} />`}
  </div>`}var vo=({why:e})=>a`<div class="columns even">
  <${C} id="margin" title="Where the margin comes from" note=${_o(e)}><${$o} why=${e} /><//>
  <div class="stack">
    <${C} id="flips" title="At which belief the choice changes" note=${e.flips?.length?"Coloured: the action that is better now. Grey: the other one. The line is the belief now.":""}><${go} why=${e} /><//>
    <${C} id="leads" title="What each response leads to"><${bo} why=${e} /><//>
  </div>
</div>`;function _o(e){if(e.is_close){let n=e.simulations_to_tell?`about ${e.simulations_to_tell.toLocaleString("en")} simulations would tell`:"no number of simulations is sure to tell";return`Too close to call against ${e.other}: ${n}.`}let t=e.margin_stderr>=.005?` ± ${H(e.margin_stderr)}`:"";return`${U(e.margin)}${t} over ${e.other}, ${e.is_exact?"exactly":`by ${e.planner}`}.`}function $o({why:e}){let[t,n]=z(),s=(e.terms??[]).map(l=>({...l,margin:l.value-l.other})).filter(l=>Math.abs(l.margin)>5e-4),o=(e.rest??0)-(e.other_rest??0);Math.abs(o)>5e-4&&s.push({place:"later steps",margin:o});let i=Math.max(...s.map(l=>Math.abs(l.margin)),1e-9),r=Math.max(80,n-(n<420?190:250)),c=l=>r/2+l/i*(r/2-2),d=j(w.value.name,"documents",w.value.step);return a`<div class="terms" ref=${t}>
    ${!s.length&&a`<p class="empty">${e.remark||"No line of the documents tells them apart."}</p>`}
    <ul>${s.slice(0,12).map(l=>a`<li aria-label=${`${U(l.margin,3)} from ${l.place}`}>
      <span class="term-place">${l.place==="later steps"?l.place:a`<a href=${d}>${l.place}</a>`}</span>
      <svg width=${r} height="18" aria-hidden="true">
        <line class="rail" x1=${r/2} x2=${r/2} y1="0" y2="18" />
        <rect class=${l.margin>0?"for":"against"} x=${Math.min(c(0),c(l.margin))} y="4" width=${Math.max(1,Math.abs(c(l.margin)-c(0)))} height="10" rx="2" />
      </svg>
      <span class="number">${U(l.margin,2)}</span>
    </li>`)}</ul>
    ${e.remark&&s.length>0&&a`<p class="aside">${e.remark}</p>`}
  </div>`}function go({why:e}){let[t,n]=z(),s=Math.max(100,n),o=r=>r*s,i=(e.flips??[]).slice(0,5);return a`<div class="flips" ref=${t}>
    ${!i.length&&a`<p class="empty">${e.remark||`No probability of one value makes ${fs(e)} better.`}</p>`}
    ${i.map(r=>{let c=(r.low+r.high)/2>r.now,[d,l]=c?[r.high,1]:[0,r.low],p=c?"above":"below",u=r.high-r.low>.001?`${p} a probability between ${M(r.low)} and ${M(r.high)}`:`${p} ${M((r.low+r.high)/2)}`;return a`<figure class="flip">
        <figcaption>P(<span class="code">${r.variable} = ${r.value}</span>) is ${M(r.now)}; ${Y(fs(e))} wins ${u}${r.is_checked?"":", not checked by planning"}</figcaption>
        <svg width=${s} height="22" aria-hidden="true">
          <rect class="this" x="0" y="3" width=${s} height="16" rx="3" />
          <rect class="between" x=${o(r.low)} y="3" width=${Math.max(1,o(r.high)-o(r.low))} height="16" />
          <rect class="other" x=${o(d)} y="3" width=${Math.max(1,o(l)-o(d))} height="16" rx="3" />
          <line class="now" x1=${o(r.now)} x2=${o(r.now)} y1="0" y2="22" />
        </svg>
      </figure>`})}
  </div>`}var bo=({why:e})=>a`<ul class="leads">
  ${(e.expected??[]).map(t=>a`<li class=${t.is_seen?"is-seen":""}>
    <p><span class="response">${t.response}</span> <span class="muted">${Q(t.probability)}</span>${t.is_seen&&a` <b>seen</b>`}</p>
    <p class="muted">${t.action?a`goal ${M(t.goal_probability??0)}; next would be <span class="response">${t.action}</span>, worth ${U(t.value)}`:`goal ${M(t.goal_probability??0)}; the mission would be over`}</p>
  </li>`)}
</ul>`;function yo({name:e,step:t}){let[n,s]=$({forbid:"",without:"",believe:"",change:""}),[o,i]=$(null),[r,c]=$(null),[d,l]=$(!1);if(!q())return null;let p=[["forbid","Without this action now",g.value?.action??""],["without","Without this skill for good",g.value?.skill??""],["believe","With another belief","variable=value:0.5"],["change","With another number in the documents","file:line=number"]];async function u(f){f.preventDefault(),l(!0),c(null);let h={};for(let[v]of p)n[v].trim()&&(h[v]=[n[v].trim()]);try{i(await ie(`/v1/missions/${encodeURIComponent(e)}/decisions/${t}/whatif`,h))}catch(v){i(null),c(v)}l(!1)}return a`<${C} id="whatif" title="What if" className="whatif" note="The step is decided anew; the mission is not touched.">
    <form onSubmit=${u}>
      ${p.map(([f,h,v])=>a`<label class="field">${h}<input value=${n[f]} placeholder=${v} onInput=${m=>s({...n,[f]:m.target.value})} /></label>`)}
      <button class="primary" disabled=${d}>${d?"Deciding…":"Decide anew"}</button>
    </form>
    <div role="status">${o&&a`<p class="supposed">${o.action===o.before?"Still ":"Then "}<b class="action">${o.action}</b>, worth <b>${U(o.value)}</b>${o.action===o.before?"":a`, in place of ${o.before} with ${U(o.value_before)}`}.</p>
      ${(o.supposed??[]).map(f=>a`<p class="muted">Supposed: ${f}</p>`)}
      ${o.remark&&a`<p class="muted">${o.remark}</p>`}`}</div>
    <${R} problem=${r} />
  <//>`}var vs=()=>a`<div class="columns even">
  <${wo} />
  <${C} id="expected" title="Expected against seen" note="The ring is how often the model expected a response, the dot how often it came; the bar holds the true frequency with 95 %.">
    <${So} />
  <//>
  <${C} id="strip" title="Decision strip" note="What was chosen at which probability, in this mission. The larger a dot, the more often.">
    <${Co} />
  <//>
</div>`;function wo(){let e=dt.value;return e.length?a`<${C} id="alarms" title="The model does not hold" className="alarms" note="Where the model is right, the probability that any such alarm ever comes is 1 % at most.">
    <div class="scroll" tabindex="0" role="region" aria-label="Table of alarms"><table>
      <thead><tr><th>Skill</th><th>Response</th><th class="num">Modelled</th><th class="num">Seen</th><th class="num">Uses</th><th class="num" title="The step at which it began">Since</th></tr></thead>
      <tbody>${e.map(t=>a`<tr onClick=${()=>F(t.since)}>
        <td class="action">${t.skill}</td><td class="response">${t.response}</td>
        <td class="num">${H(t.modelled)}</td><td class="num mark">${H(t.seen)}</td><td class="num">${t.uses}</td>
        <td class="num"><button class="row-step" aria-label=${`Step ${t.since}`}>${t.since}</button></td>
      </tr>`)}</tbody>
    </table></div>
  <//>`:null}function xo(){let e=new Map;for(let t of T.value){if(t.status!=="observed")continue;e.has(t.skill)||e.set(t.skill,{uses:0,responses:new Map});let n=e.get(t.skill);n.uses++;let s=new Set([...Object.keys(t.predicted??{}),t.seen]);for(let o of s){let i=n.responses.get(o)??{expected:0,seen:0};i.expected+=t.predicted?.[o]??0,o===t.seen&&i.seen++,n.responses.set(o,i)}}return e}function ko(e,t){let s=e/t,o=(s+1.96*1.96/(2*t))/(1+1.96*1.96/t),i=1.96*Math.sqrt(s*(1-s)/t+1.96*1.96/(4*t*t))/(1+1.96*1.96/t);return[Math.max(0,o-i),Math.min(1,o+i)]}function So(){let[e,t]=z(),n=xo(),s=Math.max(90,t-(t<480?132:250)),o=i=>8+i*(s-16);return a`<div class="expected" ref=${e}>
    ${!n.size&&a`<p class="empty">Nothing has been observed yet.</p>`}
    ${[...n].map(([i,{uses:r,responses:c}])=>a`<div class="skill" key=${i}>
      <h3>${i} <span class="muted">${r} ${r===1?"use":"uses"}</span></h3>
      <ul>${[...c].sort((d,l)=>l[1].seen-d[1].seen).map(([d,{expected:l,seen:p}])=>{let[u,f]=ko(p,r),h=l/r,v=h<u||h>f;return a`<li class=${v?"is-off":""} aria-label=${`${d}: expected ${Q(h)}, seen ${Q(p/r)}, ${p} of ${r}${v?", outside of the interval":""}`}>
          <span class="response-name">${d}</span>
          <svg width=${s} height="18" aria-hidden="true">
            <line class="rail" x1="8" x2=${s-8} y1="9" y2="9" />
            <line class="error" x1=${o(u)} x2=${o(f)} y1="9" y2="9" />
            <circle class="ring" cx=${o(h)} cy="9" r="5.5" />
            <circle class="dot" cx=${o(p/r)} cy="9" r="3.5" />
          </svg>
          <span class="number">${p}/${r}${v?a` <b title="The model's frequency is outside of the interval">!</b>`:""}</span>
        </li>`})}</ul>
    </div>`)}
  </div>`}function Co(){let[e,t]=z(),[n,s]=$(""),i=Vt(V.value).filter(m=>m.isDoubtful).flatMap(m=>m.values.filter(_=>_!=="…"&&!(_==="false"&&m.values.includes("true"))).map(_=>`${m.name} = ${_}`)),r=i.includes(n)?n:i[0];if(!r)return a`<div ref=${e}><p class="empty">No variable is in doubt.</p></div>`;let[c,d]=r.split(" = "),l=new Map;T.value.forEach((m,_)=>{let b=V.value[_]?.[c]?.[d]??0;l.has(m.action)||l.set(m.action,[]),l.get(m.action).push({share:b,step:m})});let p=28,u=t<480,f=Math.max(120,t-(u?120:190)),h=m=>10+m*(f-20),v=[...l].sort((m,_)=>ms(m[1])-ms(_[1])).slice(0,14);return a`<div class="strip" ref=${e}>
    <label class="pick">Probability of <select value=${r} onChange=${m=>s(m.target.value)}>
      ${i.map(m=>a`<option value=${m}>${m}</option>`)}</select></label>
    <div class="strip-rows">
      ${v.map(([m,_])=>a`<div class="strip-row" key=${m}>
        <span class="value-name" title=${m}>${Y(m)}</span>
        <svg width=${f} height=${p} role="img" aria-label=${`${m}: chosen at ${_.slice(0,12).map(b=>M(b.share)).join(", ")}`}>
          <line class="rail" x1="10" x2=${f-10} y1=${p/2} y2=${p/2} />
          ${Mo(_).map(({share:b,at:y})=>a`<circle class=${y.includes(g.value)?"is-now":""} cx=${h(b)} cy=${p/2} r=${Math.min(12,3.5+1.5*Math.sqrt(y.length))} onClick=${()=>F(y[0].step)}><title>${`${M(b)}: ${y.length>1?`${y.length} steps`:`step ${y[0].step}`}`}</title></circle>`)}
        </svg>
      </div>`)}
      <div class="strip-row axis" aria-hidden="true"><span></span><span class="axis-ends" style=${{width:`${f}px`}}><i>0</i><i>½</i><i>1</i></span></div>
    </div>
  </div>`}function Mo(e){let t=new Map;for(let{share:n,step:s}of e){let o=Math.round(n*100);t.has(o)||t.set(o,{share:n,at:[]}),t.get(o).at.push(s)}return[...t.values()]}var ms=e=>e.reduce((t,n)=>t+n.share,0)/e.length;var _s=()=>a`<div class="columns">
  <${C} id="all-steps" title="Steps" className="wide"><${Kt} /><//>
  <${C} id="activation" title=${g.value?`Activation of step ${g.value.step}`:"Activation"}><${Eo} /><//>
</div>`,gt=150;function Kt(){let e=ce(null),[t,n]=$(!1),s=g.value?.step,o=T.value,i=o.length>gt&&!t,r=i?Math.max(0,Math.min(o.length-gt,Math.round((ne.value-gt/2)/25)*25)):0,c=i?o.slice(r,r+gt):o;return k(()=>{let d=e.current?.querySelector("[aria-selected=true]"),l=e.current?.closest(".scroll");d&&l&&(d.offsetTop<l.scrollTop+30||d.offsetTop+d.offsetHeight>l.scrollTop+l.clientHeight)&&(l.scrollTop=d.offsetTop-l.clientHeight/2)},[s]),a`<div class="scroll" tabindex="0" role="region" aria-label="Table of steps">
    <table class="steps">
      <thead><tr><th>Step</th><th>Action</th><th class="num wide-only">Value</th><th>Seen</th><th class="num wide-only">Expected</th><th class="num">Surprise</th><th class="num wide-only">Goal</th></tr></thead>
      <tbody ref=${e}>${c.map(d=>a`<${To} key=${d.step} step=${d} isNow=${d.step===s} />`)}</tbody>
    </table>
    ${i&&a`<button class="link" onClick=${()=>n(!0)}>Show all ${o.length} steps</button>`}
  </div>`}var To=({step:e,isNow:t})=>a`<tr aria-selected=${t} onClick=${()=>F(e.step)}>
  <td><button class="row-step" aria-label=${`Step ${e.step}`}>${e.step}</button></td>
  <td class="action" title=${e.action}>${Y(e.action)}</td>
  <td class="num wide-only">${U(e.value)}</td>
  <td>${e.status?ze(e)?a`<span class="bad">✕ ${e.status.replace("_"," ")}</span>`:e.seen:a`<span class="muted">running</span>`}</td>
  <td class="num wide-only">${e.status?M(e.expected):""}</td>
  <td class="num">${e.status?a`${He(e)?a`<span class="mark" aria-label="surprising">▲ </span>`:""}${e.impossible?"∞":H(e.surprise)}`:""}</td>
  <td class="num wide-only">${M((e.endings_after??e.endings)?.goal)}</td>
</tr>`;function Eo(){let e=ve.value,t=g.value;if(!t||!e)return a`<p class="empty">There is no step yet.</p>`;let n=e.observed??e.decided,s=e.observed?.outcome,o=s?(s.ended_ns-s.started_ns)/1e9:null,i=Object.entries(s?.local_variables??{});return a`<div class="activation">
    <p class="big-action">${t.action}</p>
    <dl class="facts">
      <div><dt>Outcome</dt><dd>${s?`${s.status.replace("_"," ")}${s.response?`: ${s.response}`:""}`:"running"}</dd></div>
      ${o!==null&&a`<div><dt>Took</dt><dd>${We(o)}</dd></div>`}
      <div><dt>Decided in</dt><dd>${We(n.planning_s)}${n.planner?`, by ${n.planner}`:""}</dd></div>
      ${n.why&&a`<div><dt>Why this planner</dt><dd>${n.why}</dd></div>`}
      <div><dt>Look-ahead</dt><dd>${n.horizon} decisions</dd></div>
      <div><dt>Model</dt><dd>revision ${n.revision}, <code>${n.model_digest.slice(0,12)}</code></dd></div>
      <div><dt>Belief</dt><dd>${n.belief.states.toLocaleString("en")} ${n.belief.states===1?"state":"states"}, ${n.belief.is_exact?"exact":"sampled"}</dd></div>
      ${Object.entries(s?.numbers??{}).map(([r,c])=>a`<div><dt>${r}</dt><dd>${JSON.stringify(c)}</dd></div>`)}
      ${Object.entries(s?.monitors??{}).map(([r,c])=>a`<div><dt>${r}</dt><dd>${c}</dd></div>`)}
    </dl>
    <h3>Local variables</h3>
    ${i.length?a`<dl class="facts mono">${i.map(([r,c])=>a`<div><dt>${r}</dt><dd>${c}</dd></div>`)}</dl>`:a`<p class="empty">${s?"The mapping has none.":"They come with the outcome."}</p>`}
  </div>`}function $s(){let[e,t]=$(null),[n,s]=$(null),[o,i]=$(""),r=g.value,c=r?.revision??0,{name:d}=w.value;if(k(()=>{let h=!0;return A(`/v1/missions/${encodeURIComponent(d)}/documents?revision=${c}`).then(v=>h&&(t(v),s(null)),v=>h&&s(v)),()=>h=!1},[d,c,!!D.value]),k(()=>i(""),[r?.skill]),n)return a`<${R} problem=${n} />`;if(!e)return a`<p class="empty">Reading the documents…</p>`;let l=(e.skills[r?.skill]??[]).filter(h=>h.what==="model"||h.what===`rule ${r?.seen}`),p=o||l[0]?.file||e.files[0]?.name,u=e.files.find(h=>h.name===p)?.text??"",f=l.map(h=>h.file);return a`<${C} id="documents" title=${`Documents of ${e.project}`} note=${`Revision ${e.revision}${r?`; the lines of ${r.skill} are marked`:""}.`}>
    <div class="files" role="tablist" aria-label="Files">
      ${e.files.map(h=>a`<button role="tab" aria-selected=${h.name===p} class=${f.includes(h.name)?"is-about":""} onClick=${()=>i(h.name)}>${h.name}</button>`)}
    </div>
    <${Oo} key=${p} text=${u} marked=${l.filter(h=>h.file===p)} />
  <//>`}function Oo({text:e,marked:t}){let n=ce(null);return k(()=>{let s=n.current?.querySelector(".is-marked");s&&(n.current.scrollTop=Math.max(0,s.offsetTop-60))},[t.map(s=>s.first).join()]),a`<pre class="source" ref=${n} tabindex="0"><code>${e.split(`
`).map((s,o)=>{let i=t.find(r=>r.first<=o+1&&o+1<=r.last);return a`<span class=${i?"line is-marked":"line"} data-line=${o+1}>${s||" "}\n</span>`})}</code></pre>`}function gs(){let[e,t]=$(null),{name:n}=w.value,s=g.value?.step,o=!!g.value?.status;return k(()=>{if(!ke.value||!s)return;let i=!0,r=l=>i&&t(l),c=`/v1/missions/${encodeURIComponent(n)}/decisions/${s}/picture`,d=setTimeout(()=>Dn(c).then(l=>r({step:s,url:URL.createObjectURL(l)}),l=>r({step:s,problem:l})),150);return()=>{i=!1,clearTimeout(d)}},[n,s,o,ke.value]),k(()=>()=>e?.url&&URL.revokeObjectURL(e.url),[e]),ke.value?a`<${C} id="drawn" title="State" note="The likeliest value of each variable, as the bundle draws it.">
    <${R} problem=${e?.problem} />
    ${e?.url&&a`<figure class="picture"><img src=${e.url} alt=${`The state after step ${e.step}`} /></figure>`}
  <//>`:null}function bs(){let e=D.value,[t,n]=$(null),[s,o]=$(null),[i,r]=$([]),[c,d]=$(""),[l,p]=$(""),[u,f]=$(null),h=e&&encodeURIComponent(e.run);k(()=>{h&&(A(`/v1/runs/${h}`).then(n,f),A(`/v1/runs/${h}/services`).then(o,f),A(`/v1/runs/${h}/bundles`).then(_=>r(_.entries),()=>r([])))},[h,De.value.length,fe.value.size]);let v=s?.services.find(_=>_.service==="solver")?.service??s?.services[0]?.service,m=c||v;return k(()=>{if(!h||!m)return;let _=()=>Fn(`/v1/runs/${h}/logs/${m}?tail=60000`).then(p,f);_();let b=e.is_running?setInterval(_,2e3):null;return()=>clearInterval(b)},[h,m,e?.is_running]),e?a`<div class="columns">
    <${C} id="logs" title="Logs" className="wide">
      <div class="files" role="tablist" aria-label="Processes">
        ${(s?.services??[]).map(_=>a`<button role="tab" aria-selected=${_.service===m} onClick=${()=>d(_.service)}>
          ${e.is_running&&a`<i class=${`presence ${fe.value.get(_.service)?"is-there":""}`} title=${fe.value.get(_.service)?"on the bus":"not on the bus"}></i>`}${_.service}</button>`)}
      </div>
      <pre class="source log" tabindex="0" aria-label=${`Log of ${m}`}>${l||"The log is empty."}</pre>
      <${R} problem=${u} />
    <//>
    <div class="stack">
      <${C} id="run" title="Run">
        ${t&&a`<dl class="facts">
          <div><dt>Robot</dt><dd>${t.robot}</dd></div>
          <div><dt>Started</dt><dd>${ht(t.started)}</dd></div>
          <div><dt>Deploy file</dt><dd class="path">${t.deploy_file}</dd></div>
          <div><dt>Directory</dt><dd class="path">${t.directory}</dd></div>
          <div><dt>Seed</dt><dd>${e.mission?.seed??t.seed}</dd></div>
          ${t.is_played&&a`<div><dt>Skills</dt><dd>played by their documents</dd></div>`}
          ${t.sandbox&&a`<div><dt>Documents</dt><dd>${t.sandbox}</dd></div>`}
        </dl>`}
        ${(s?.ends??[]).map(_=>a`<p class="aside"><b>${_.name}</b> ended after ${_.after_s.toFixed(1)} s, ${_.how}: ${_.then}</p>`)}
      <//>
      <${C} id="bundles" title="Documents">
        <ul class="bundles">${i.map(_=>a`<li><b>${_.project}</b> revision ${_.revision}<span class="muted">${_.skills.join(", ")}</span></li>`)}</ul>
        ${e.is_running&&a`<${No} run=${e.run} />`}
      <//>
    </div>
  </div>`:null}function No({run:e}){let[t,n]=$(null),[s,o]=$("");async function i(r){let c=r.target.files[0];if(c){o(`Sending ${c.name}…`),n(null);try{let d=await ct(`/v1/runs/${encodeURIComponent(e)}/bundles`,c),l=[...d.added??[],...d.changed??[]].join(", ");o(`Accepted: revision ${d.revision}${l?`, ${l}`:", nothing new"}.`)}catch(d){o(""),n(d)}r.target.value=""}}return a`<div class="push">
    ${q()?a`<label class="button">Give it documents…<input type="file" class="visually-hidden" onChange=${i} accept=".zip,.tar,.gz,.tgz,.xz,.bz2,.ef,.sd,.am,.lf,.json" /></label>
          <p class="note">A document, or an archive of some. They take over at a decision, and the mission goes on.</p>`:a`<p class="note">Open the address that <code>aos serve</code> prints to change something here.</p>`}
    <p role="status">${s}</p>
    <${R} problem=${t} />
  </div>`}var Ro={overview:"Overview",why:"Why",steps:"Steps",model:"Model",documents:"Documents",system:"System"},Ao={overview:jo,why:hs,steps:_s,model:vs,documents:$s,system:bs};function ys(){let{name:e,view:t}=w.value;k(()=>(ft(e),zn),[e]);let n=g.value?.step,s=g.value&&!g.value.status;if(k(()=>{if(!n)return;let i=setTimeout(()=>Bn(n),60);return()=>clearTimeout(i)},[e,n,s]),X.value&&!D.value)return a`<main id="main" class="page"><h1>${e}</h1><${R} problem=${X.value} /><p><a href="#/">All missions</a></p></main>`;let o=Ao[t];return a`<main id="main" class="page">
    <${Io} />
    <${ts} />
    <div class="hero card">
      <${is} />
      <${os} />
    </div>
    <nav class="views" aria-label="Views">
      ${Dt.map(i=>a`<a href=${j(e,i,w.value.step)} aria-current=${i===t?"page":null}>${Ro[i]}</a>`)}
    </nav>
    <${o} />
  </main>`}function Io(){let e=D.value,t=O.value,n=t?.phase==="ended",s=g.value&&(me.value||g.value===Ue.value?g.value.endings_after??g.value.endings:g.value.endings_after??g.value.endings),o=s?.goal??t?.goal_probability;return a`<header class="head">
    <div class="head-name">
      <h1>${e?.robot??" "}</h1>
      <p class="muted">${w.value.name}</p>
    </div>
    <div class="head-state">
      <p class=${`phase is-${n?t.ending:t?.phase??"waiting"}`} role="status">
        <i class=${n||!e?.is_running?"still-dot":"pulse"}></i>${n?mt(t.ending):Kn(t?.phase??"waiting")}
        ${!me.value&&a`<span class="past">showing step ${g.value?.step}</span>`}
      </p>
      <p class="remark">${t?.remark??""}</p>
      <${Po} />
    </div>
    <div class="goal" title="How probable the goal is, as the belief has it">
      <span class="goal-number">${M(o)}</span><span class="goal-word">goal</span>
      <svg viewBox="0 0 100 4" preserveAspectRatio="none" aria-hidden="true"><rect width="100" height="4" class="goal-rail" /><rect width=${(o??0)*100} height="4" class="goal-bar" /></svg>
      ${s?.failure>5e-4&&a`<span class="failure">failure ${M(s.failure)}</span>`}
    </div>
    <${Qn} />
  </header>`}function Po(){let e=[...new Set(dt.value.map(s=>s.skill))];if(!e.length)return null;let{name:t,step:n}=w.value;return a`<p><a class="alarm" href=${j(t,"model",n)}><svg width="11" height="11" viewBox="0 0 10 10" aria-hidden="true"><path d="M5 0 l5 9.5 h-10z" /></svg>The model of ${e.join(", ")} does not hold</a></p>`}function jo(){return a`<div class="columns overview">
    <div class="stack">
      <${C} id="belief" title="Belief" note=${Do()}><${as} /><//>
      <${gs} />
      <${C} id="all-steps" title="Steps"><${Kt} /><//>
    </div>
    <div class="stack">
      <${C} id="values" title="Values of the actions"><${cs} /><${es} /><//>
      ${J.value.length>0&&a`<${C} id="world" title="World"><${Fo} /><//>`}
    </div>
  </div>`}var Do=()=>V.value.length?`After ${me.value?"the newest step":`step ${g.value?.step}`}.`:"";function Fo(){let e=J.value,t=g.value?.step??0,n=e.filter(s=>s<=t).at(-1)??e[0];return n===void 0?null:a`<figure class="picture"><img src=${`/v1/missions/${encodeURIComponent(w.value.name)}/world/${n}`} alt=${`The world after step ${n}`} />
    <figcaption class="note">After step ${n}</figcaption></figure>`}var Jt="aos-theme",ws=e=>e?document.documentElement.dataset.theme=e:delete document.documentElement.dataset.theme;ws(localStorage.getItem(Jt));var Uo={live:"Live",lost:"Connection lost, trying again",connecting:"Connecting",over:"Recorded"};function Lo(){let{kind:e,name:t}=w.value,n=e==="missions"&&t;return k(()=>{e==="runs"&&t?Wo(t):n||(Le(),pt())},[e,t]),a`
    <a class="skip" href="#main" onClick=${s=>{s.preventDefault(),document.getElementById("main")?.focus()}}>To the content</a>
    <header class="bar">
      <a class="brand" href="#/" aria-label="AOS, all missions"><svg viewBox="0 0 32 32" width="22" height="22" aria-hidden="true"><rect width="32" height="32" rx="8" /><path d="M6 21c5 0 5-10 10-10s5 10 10 10" /><circle cx="16" cy="11" r="3.2" /></svg><span>AOS</span></a>
      ${n&&a`<nav aria-label="Place"><a href="#/">Missions</a></nav>`}
      <span class="room"></span>
      <span class=${`connection is-${Z.value}`} role="status"><i></i>${n||Z.value==="lost"?Uo[Z.value]:""}</span>
      <${Ho} />
    </header>
    ${n?a`<${ys} key=${t} />`:a`<${Zn} />`}`}async function Wo(e){await Le();let t=(xe.value??[]).find(n=>n.run===e);re(j(t?.missions?.at(-1)??e),{replace:!0})}function Ho(){let[e,t]=$(localStorage.getItem(Jt)??""),n=e?e==="dark":matchMedia("(prefers-color-scheme: dark)").matches;function s(){let o=n?"light":"dark";localStorage.setItem(Jt,o),ws(o),t(o)}return a`<button class="quiet theme" onClick=${s} aria-label=${n?"Light colours":"Dark colours"} title=${n?"Light colours":"Dark colours"}>${n?"☀":"☾"}</button>`}addEventListener("keydown",e=>{if(!(e.target instanceof Element&&e.target.closest("input, select, textarea, .scroll, .source, [role=tab]")||e.ctrlKey||e.metaKey||e.altKey||!g.value)){if(e.key==="ArrowLeft")F(g.value.step-1);else if(e.key==="ArrowRight")F(g.value.step+1);else if(e.key==="Home")F(T.value[0].step);else if(e.key==="End")F(null);else return;e.preventDefault()}});await Un();Mt(a`<${Lo} />`,document.getElementById("page"));
